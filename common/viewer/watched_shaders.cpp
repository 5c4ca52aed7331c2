#include "viewer/watched_shaders.h"

#include "error.h"
#include "files/file.h"

namespace lab {

uint64_t hash_of(const ShaderFiles& files) {
    uint64_t hash = 0;
    try {
        for (const auto& file : files) hash = hash_text(read_file(file, max_shader_bytes), hash + 1);
    } catch (const UserError&) {
        return 0;
    }
    return hash;
}

void WatchedShaders::look(const std::function<ShaderFiles()>& find_files) {
    constexpr double interval = 0.1;
    if (seconds_since(last_look_) < interval) return;
    last_look_ = Clock::now();
    if (have_failed()) try {
            files_ = find_files();
        } catch (const UserError&) {
            // A file is missing: the message already says so.
        }
    if (const uint64_t hash = hash_of(files_); hash != 0) hash_ = hash;
    if (hash_ == compiled_) failed_ = 0;
}

void WatchedShaders::blame(uint64_t hash) {
    if (hash_of(files_) == hash) failed_ = hash;
}

}  // namespace lab
