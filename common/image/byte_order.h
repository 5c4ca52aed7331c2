// Numbers as files hold them.
#pragma once
#include <bit>
#include <cstdint>
#include <string>

namespace lab {

inline std::string big_endian(uint32_t number) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 255);
    return bytes;
}

// Of the number's own size.
template <typename Number>
std::string little_endian(Number number) {
    static_assert(std::endian::native == std::endian::little);
    return {reinterpret_cast<const char*>(&number), sizeof number};
}

}  // namespace lab
