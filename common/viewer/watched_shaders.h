// The files that a shader is compiled from, watched for edits.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>

#include "clock.h"

namespace lab {

using ShaderFiles = std::set<std::filesystem::path>;

// Hash of the contents of all files; 0 if one cannot be read, such as while an editor replaces it.
uint64_t hash_of(const ShaderFiles& files);

class WatchedShaders {
  public:
    // `hash` is that of the contents that have been compiled.
    WatchedShaders(ShaderFiles files, uint64_t hash) : files_(std::move(files)), hash_(hash), compiled_(hash) {}

    // Reads the files, at most ten times a second. If the last ones did not compile, `find_files` says which they are by now: the
    // broken shader may include others than the last good one. It may throw UserError.
    void look(const std::function<ShaderFiles()>& find_files);
    // Whether they differ from those that compiled, and from those that did not.
    bool have_changed() const { return hash_ != compiled_ && hash_ != failed_; }
    bool have_failed() const { return failed_ != 0; }
    uint64_t hash() const { return hash_; }

    // The contents with this hash did not compile, unless the files have changed since: then they may not be to blame.
    void blame(uint64_t hash);

  private:
    ShaderFiles files_;
    uint64_t hash_;        // at the last look
    uint64_t compiled_;    // that of the render
    uint64_t failed_ = 0;  // that did not compile; 0 if the last ones did
    Clock::time_point last_look_{};
};

}  // namespace lab
