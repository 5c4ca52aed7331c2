#include "files/cache.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "error.h"
#include "files/file.h"
#include "platform.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

constexpr uintmax_t largest_size = 512 << 20;  // of all entries

// Removes entries until the others fit, the oldest first. Other programs may do the same at the same time.
void remove_old_entries(const fs::path& folder) try {
    struct Entry {
        fs::file_time_type time;
        uintmax_t size;
        fs::path file;
    };
    std::vector<Entry> entries;
    uintmax_t size = 0;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        if (!entry.is_regular_file(error)) continue;  // a compiler's folder
        entries.push_back({entry.last_write_time(error), entry.file_size(error), entry.path()});
        if (error)
            entries.pop_back();
        else
            size += entries.back().size;
    }
    std::ranges::sort(entries, {}, &Entry::time);
    for (auto oldest = entries.begin(); size > largest_size && oldest != entries.end(); size -= oldest++->size)
        fs::remove(oldest->file, error);
} catch (const fs::filesystem_error&) {  // an entry may vanish meanwhile
}

}  // namespace

std::string cache_name(const std::string& kind, std::string_view key) {
    return kind + "-" + hexadecimal(hash_text(key)) + "-" + hexadecimal(hash_text(key, key.size()));
}

// There is none without a home folder: in a folder that all users share, others could replace a shader.
fs::path cache_file(const std::string& name) {
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
        return fs::path(folder) / "path_tracing_lab" / name;
    const fs::path home = user_folder();
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
    std::error_code ignored;
    fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);  // the last use
    return stored == hash_text(bytes) ? std::optional(std::move(bytes)) : std::nullopt;
} catch (const UserError&) {
    return std::nullopt;
}

std::string write_cache(const std::string& name, std::string_view contents) {
    const auto file = cache_file(name);
    if (file.empty()) return "there is no folder for a cache";
    std::error_code ignored;
    fs::create_directories(file.parent_path(), ignored);
    const uint64_t hash = hash_text(contents);
    std::string bytes(contents);
    bytes.append(reinterpret_cast<const char*>(&hash), sizeof hash);
    try {
        write_file(file, bytes);
        remove_old_entries(file.parent_path());
        return "";
    } catch (const UserError& error) {
        return error.what();
    }
}

}  // namespace lab
