// Hashes that name contents: of cache entries, scenes and estimators.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace lab {

// FNV-1a of a text, continued from `hash`.
uint64_t hash_text(std::string_view text, uint64_t hash = 14695981039346656037ull);

// A hash as records and reports write it: without leading zeros.
std::string hexadecimal(uint64_t number);

}  // namespace lab
