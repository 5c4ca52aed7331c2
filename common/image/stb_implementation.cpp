// Compiles the stb libraries. radiance.cpp reads .hdr itself, because stb_image does not end on some
// truncated files.
#include <cstring>

#include "image/encoding.h"
#include "image/stb_memory.h"

// For PNG: the threads that stb does not use.
static unsigned char* compress_for_stb(unsigned char* data, int size, int* compressed_size, int) {
    const std::string bytes =
        lab::compress_in_parallel({reinterpret_cast<const char*>(data), static_cast<size_t>(size)});
    auto* result = static_cast<unsigned char*>(std::malloc(bytes.size()));
    if (result) std::memcpy(result, bytes.data(), bytes.size());
    *compressed_size = static_cast<int>(bytes.size());
    return result;
}

#define STBI_MALLOC(size) lab::stb_allocate(nullptr, size)
#define STBI_REALLOC(block, size) lab::stb_allocate(block, size)
#define STBI_FREE(block) std::free(block)
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_NO_STDIO
#define STBI_ONLY_BMP
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_ONLY_TGA
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBIW_ZLIB_COMPRESS compress_for_stb
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#include <stb_image_write.h>
#pragma GCC diagnostic pop
