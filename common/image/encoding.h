// What the writers of image files share: numbers as bytes, and compression by zlib.
#pragma once
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace lab {

// Of the number's own size.
template <typename Number>
std::string little_endian(Number number) {
    static_assert(std::endian::native == std::endian::little);
    return {reinterpret_cast<const char*>(&number), sizeof number};
}

// One zlib stream, made by the calling thread.
std::string compress(std::string_view bytes);

// One zlib stream as well, made by all threads: it consists of pieces that know nothing of each other.
std::string compress_in_parallel(std::string_view bytes);

}  // namespace lab
