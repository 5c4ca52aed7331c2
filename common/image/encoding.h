// Numbers as bytes, and zlib compression.
#pragma once
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace lab {

// The bytes of a number.
template <typename Number>
std::string little_endian(Number number) {
    static_assert(std::endian::native == std::endian::little);
    return {reinterpret_cast<const char*>(&number), sizeof number};
}

// A zlib stream of independent pieces, compressed by all threads.
std::string compress_in_parallel(std::string_view bytes);

}  // namespace lab
