// The files that a scene is read from.
#pragma once
#include "files/file.h"
#include "files/hash.h"

namespace lab {

// Reads files and hashes their contents in reading order, to recognise changed scenes.
class SourceFiles {
  public:
    // As read_file().
    std::string read(const std::filesystem::path& file, uint64_t max_bytes) {
        std::string bytes = read_file(file, max_bytes);
        hash_ = hash_text(bytes, hash_);
        return bytes;
    }

    uint64_t hash() const { return hash_; }

  private:
    uint64_t hash_ = hash_text("");
};

}  // namespace lab
