#include "files/cache.h"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "files/hash.h"
#include "platform.h"

namespace lab {
namespace {

// Empty where nobody says whose cache it is: in a folder that all users share, others could replace a shader.
std::filesystem::path cache_folder() {
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
        return std::filesystem::path(folder) / "path_tracing_lab";
    const std::filesystem::path home = user_folder();
    return home.empty() ? home : home / ".cache" / "path_tracing_lab";
}

// The last eight bytes of an entry are the hash of the others.
uint64_t checksum(const uint8_t* bytes, size_t size) {
    return hash_text({reinterpret_cast<const char*>(bytes), size});
}

}  // namespace

std::optional<std::vector<uint8_t>> read_cache(const std::string& name) {
    const auto folder = cache_folder();
    if (folder.empty()) return std::nullopt;
    std::ifstream stream(folder / name, std::ios::binary);
    std::vector<uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
    uint64_t stored = 0;
    if (bytes.size() < sizeof stored) return std::nullopt;
    const size_t size = bytes.size() - sizeof stored;
    std::memcpy(&stored, bytes.data() + size, sizeof stored);
    if (stored != checksum(bytes.data(), size)) return std::nullopt;
    bytes.resize(size);
    return bytes;
}

void write_cache(const std::string& name, const std::vector<uint8_t>& contents) {
    const auto folder = cache_folder();
    if (folder.empty()) return;
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    const auto temporary = folder / (name + "." + std::to_string(process_id()));
    const uint64_t sum = checksum(contents.data(), contents.size());
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(contents.data()),
                 static_cast<std::streamsize>(contents.size()));
    stream.write(reinterpret_cast<const char*>(&sum), sizeof sum);
    stream.close();
    if (stream)
        rename_file(temporary, folder / name, ignored);
    else
        std::filesystem::remove(temporary, ignored);
}

}  // namespace lab
