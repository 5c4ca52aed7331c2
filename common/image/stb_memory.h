// Limits the memory of stb_image, since damaged files may claim any amount.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace lab {

struct StbMemory {
    size_t largest_block = SIZE_MAX;  // bytes; a larger one counts as out of memory
    bool exceeded = false;            // whether one was asked for
};
inline thread_local StbMemory stb_memory;

inline void* stb_allocate(void* block, size_t size) {
    if (size > stb_memory.largest_block) {
        stb_memory.exceeded = true;
        return nullptr;
    }
    // Zeroed, because stb_image up to 2.27 uses tables that a damaged .jpg has not defined.
    return block ? std::realloc(block, size) : std::calloc(1, size);
}

}  // namespace lab
