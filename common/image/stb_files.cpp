// Eight-bit images: reading by stb_image, writing by stb_image_write, and the code of both libraries.
// radiance.cpp reads .hdr itself, because stb_image never returns on some truncated files.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "files/file.h"
#include "image/encoding.h"
#include "image/image.h"
#include "image/image_checks.h"
#include "image/texture_file.h"

namespace lab {

// Bounds stb_image's memory, since damaged files may claim any amount.
struct StbMemory {
    size_t largest_block = SIZE_MAX;  // bytes; anything larger counts as out of memory
    bool exceeded = false;            // whether a larger one was requested
};
static thread_local StbMemory stb_memory;

static void* stb_allocate(void* block, size_t size) {
    if (size > stb_memory.largest_block) {
        stb_memory.exceeded = true;
        return nullptr;
    }
    // Zeroed, because stb_image up to 2.27 reads tables that a damaged .jpg never defined.
    return block ? std::realloc(block, size) : std::calloc(1, size);
}

// For PNG: compresses with all threads, which stb does not.
static unsigned char* compress_for_stb(unsigned char* data, int size, int* compressed_size, int) {
    const std::string bytes = compress_in_parallel({reinterpret_cast<const char*>(data), static_cast<size_t>(size)});
    auto* result = static_cast<unsigned char*>(std::malloc(bytes.size()));
    if (result) std::memcpy(result, bytes.data(), bytes.size());
    *compressed_size = static_cast<int>(bytes.size());
    return result;
}

}  // namespace lab

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
#define STBIW_ZLIB_COMPRESS lab::compress_for_stb
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace lab {
namespace {

// stb_image pads truncated files with zeros. Reading through callbacks shows that it asked for more than there is.
struct ByteSource {
    std::string_view bytes;
    size_t position = 0;
    bool exhausted = false;

    // Only the 128 bytes that stb_image reads ahead may be cut short by the end of the file.
    static int read(void* user, char* target, int size) {
        auto& source = *static_cast<ByteSource*>(user);
        const size_t count = std::min(static_cast<size_t>(size), source.bytes.size() - source.position);
        std::memcpy(target, source.bytes.data() + source.position, count);
        source.position += count;
        if (count == 0 || (count < static_cast<size_t>(size) && size != 128)) source.exhausted = true;
        return static_cast<int>(count);
    }

    static void skip(void* user, int count) {  // backwards if negative
        auto& source = *static_cast<ByteSource*>(user);
        const int64_t target = static_cast<int64_t>(source.position) + count;
        const auto end = static_cast<int64_t>(source.bytes.size());
        if (target > end) source.exhausted = true;
        source.position = static_cast<size_t>(std::clamp<int64_t>(target, 0, end));
    }

    static int at_end(void* user) {
        const auto& source = *static_cast<ByteSource*>(user);
        return source.position == source.bytes.size();
    }
};

constexpr stbi_io_callbacks callbacks{ByteSource::read, ByteSource::skip, ByteSource::at_end};

void append(void* bytes, void* data, int size) {
    static_cast<std::string*>(bytes)->append(static_cast<const char*>(data), static_cast<size_t>(size));
}

// Paeth suits rendered pictures; trying all five takes five times as long.
[[maybe_unused]] const int png_filter = stbi_write_force_png_filter = 4;

void check_written(int success, const std::filesystem::path& file) {
    if (!success) fail(file, "the image cannot be encoded: out of memory");
}

void mirror(Texture& texture) {
    for (uint32_t y = 0; y < texture.height; ++y) {
        uint8_t* row = &texture.pixels[4 * size_t{y} * texture.width];
        for (uint32_t left = 0, right = texture.width - 1; left < right; ++left, --right)
            std::swap_ranges(row + 4 * left, row + 4 * left + 4, row + 4 * right);
    }
}

}  // namespace

Texture read_texture(const std::filesystem::path& file) {
    const TextureFile prepared = prepare_texture(file, read_file(file, max_image_file_bytes));
    const std::string& bytes = prepared.bytes;
    if (prepared.format.empty()) fail(file, "not a texture: it must be a .png, .jpg, .bmp or .tga file");
    int width = 0, height = 0, channels = 0;
    ByteSource source{bytes};
    if (!stbi_info_from_callbacks(&callbacks, &source, &width, &height, &channels))
        fail(file, "this kind of " + prepared.format + " is not supported, or it is damaged: export it again as an RGB .png");
    const int64_t rows = prepared.format == ".bmp" ? std::abs(int64_t{height}) : height;  // negative: from the top
    check_image_size(file, width, rows);
    // A pixel takes at least one deflated bit in .png, and 1/64 bit in .jpg (one bit per 8 x 8 block): refuse more before
    // allocating.
    const uint64_t max_pixels_a_byte = prepared.format == ".png" ? 8 * max_deflate_ratio : 8 * 64;
    if (static_cast<uint64_t>(width * rows) > max_pixels_a_byte * bytes.size()) fail_truncated(file);

    source = {bytes};
    stb_memory = {.largest_block = memory_limit(bytes.size())};
    const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> pixels(
        stbi_load_from_callbacks(&callbacks, &source, &width, &height, &channels, 4), stbi_image_free);
    if (stb_memory.exceeded) fail(file, "needs far more memory than a file of its size should: make the image smaller");
    if (source.exhausted) fail_truncated(file);
    if (!pixels) fail_damaged(file);
    Texture texture{static_cast<uint32_t>(width), static_cast<uint32_t>(height), {}};
    texture.pixels.assign(pixels.get(), pixels.get() + 4 * static_cast<size_t>(width) * height);
    if (prepared.is_mirrored) mirror(texture);
    if (prepared.without_alpha)
        for (size_t i = 3; i < texture.pixels.size(); i += 4) texture.pixels[i] = 255;
    return texture;
}

void write_png(const std::filesystem::path& file, const Texture& image) {
    std::string bytes;
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    check_written(stbi_write_png_to_func(append, &bytes, width, height, 4, image.pixels.data(), 0), file);
    write_file(file, bytes);
}

void write_jpg(const std::filesystem::path& file, const Texture& image) {
    constexpr int quality = 95;
    std::string bytes;
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    check_written(stbi_write_jpg_to_func(append, &bytes, width, height, 4, image.pixels.data(), quality), file);
    write_file(file, bytes);
}

void write_hdr(const std::filesystem::path& file, const Image& image) {
    // The shared 8-bit exponent cannot express a sign, infinity or NaN: they become 0 or the largest finite number.
    constexpr float largest = 1e38f;
    std::vector<float> pixels(image.pixels.size());
    std::transform(image.pixels.begin(), image.pixels.end(), pixels.begin(),
                   [largest](float value) { return value > 0 ? std::min(value, largest) : 0; });
    std::string bytes;
    const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
    check_written(stbi_write_hdr_to_func(append, &bytes, width, height, 3, pixels.data()), file);
    write_file(file, bytes);
}

}  // namespace lab
