#include "files/cache.h"

#include <cstdlib>
#include <cstring>

#include "error.h"
#include "files/file.h"
#include "platform.h"

namespace lab {

std::string cache_name(const std::string& kind, std::string_view key) {
    return kind + "-" + hexadecimal(hash_text(key)) + "-" + hexadecimal(hash_text(key, key.size()));
}

// There is none without a home folder: in a folder that all users share, others could replace a shader.
std::filesystem::path cache_file(const std::string& name) {
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
        return std::filesystem::path(folder) / "path_tracing_lab" / name;
    const std::filesystem::path home = user_folder();
    return home.empty() ? home : home / ".cache" / "path_tracing_lab" / name;
}

// The last eight bytes of an entry are a hash of the rest.
std::optional<std::string> read_cache(const std::string& name) try {
    const auto file = cache_file(name);
    if (file.empty()) return std::nullopt;
    std::string bytes = read_file(file, UINT64_MAX);
    uint64_t stored = 0;
    if (bytes.size() < sizeof stored) return std::nullopt;
    const size_t size = bytes.size() - sizeof stored;
    std::memcpy(&stored, bytes.data() + size, sizeof stored);
    bytes.resize(size);
    return stored == hash_text(bytes) ? std::optional(std::move(bytes)) : std::nullopt;
} catch (const UserError&) {
    return std::nullopt;
}

void write_cache(const std::string& name, std::string_view contents) {
    const auto file = cache_file(name);
    if (file.empty()) return;
    std::error_code ignored;
    std::filesystem::create_directories(file.parent_path(), ignored);
    const uint64_t hash = hash_text(contents);
    std::string bytes(contents);
    bytes.append(reinterpret_cast<const char*>(&hash), sizeof hash);
    try {
        write_file(file, bytes);
    } catch (const UserError&) {  // the next start just takes longer
    }
}

}  // namespace lab
