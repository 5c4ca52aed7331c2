// The one place where the code of the stb single-header libraries is compiled.
// radiance.cpp reads .hdr itself: stb_image does not end on some truncated ones.
#include "image/stb_memory.h"

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
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#include <stb_image_write.h>
#pragma GCC diagnostic pop
