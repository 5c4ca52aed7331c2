// Compression by zlib, which PNG and OpenEXR use.
#pragma once
#include <string>
#include <string_view>

namespace lab {

// One zlib stream, made by the calling thread.
std::string compress(std::string_view bytes);

// One zlib stream as well, made by all threads: it consists of pieces that know nothing of each other.
std::string compress_in_parallel(std::string_view bytes);

// The checksum of PNG.
uint32_t crc(std::string_view bytes);

}  // namespace lab
