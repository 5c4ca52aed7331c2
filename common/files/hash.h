// Hashes of contents: cache entries, scenes, estimators.
#pragma once
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

namespace lab {

// FNV-1a of a text, continued from `hash`.
inline uint64_t hash_text(std::string_view text, uint64_t hash = 14695981039346656037ull) {
    for (const char c : text) hash = (hash ^ static_cast<uint8_t>(c)) * 1099511628211ull;
    return hash;
}

// The hash as records and reports write it, without leading zeros.
inline std::string hexadecimal(uint64_t number) {
    char text[16];
    return {text, std::to_chars(text, text + sizeof text, number, 16).ptr};
}

}  // namespace lab
