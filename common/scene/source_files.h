// The files that a scene is read from.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "files/file.h"

namespace lab {

// Reads files and hashes their contents in reading order (FNV-1a, 64 bits), to recognise changed scenes.
class SourceFiles {
  public:
    // As read_file().
    std::string read(const std::filesystem::path& file, uint64_t max_bytes) {
        std::string bytes = read_file(file, max_bytes);
        for (const char byte : bytes) hash_ = (hash_ ^ static_cast<uint8_t>(byte)) * 0x100000001b3u;
        return bytes;
    }

    uint64_t hash() const { return hash_; }

  private:
    uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace lab
