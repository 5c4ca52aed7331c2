#include "files/hash.h"

#include <sstream>

namespace lab {

uint64_t hash_text(std::string_view text, uint64_t hash) {
    for (const char c : text) hash = (hash ^ static_cast<uint8_t>(c)) * 1099511628211ull;
    return hash;
}

std::string hexadecimal(uint64_t number) {
    std::ostringstream text;
    text << std::hex << number;
    return text.str();
}

}  // namespace lab
