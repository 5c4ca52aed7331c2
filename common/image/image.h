// Images and their files. Readers throw UserError for damaged files; all writers replace the file atomically.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "files/file.h"

namespace lab {

// Linear RGB, row by row from the top; `pixels` has 3 * width * height numbers.
struct Image {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<float> pixels;
};

// RGBA with 8 bits per channel: sRGB-encoded colour, linear alpha; `pixels` has 4 * width * height bytes.
struct Texture {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<uint8_t> pixels;
};

// An OpenEXR file: R, G, B as 32-bit floats, further channels and string attributes. Names have at most 31 characters. There are
// at most 128 attributes, none of them with a standard name such as "type".
struct ExrFile {
    Image image;
    std::map<std::string, std::vector<float>> channels;  // each has width * height numbers
    std::map<std::string, std::string> attributes;
    bool is_complete = true;           // whether the file has all pixels of its display window
    bool has_other_primaries = false;  // than sRGB
};

// Largest width and height of an image, in pixels.
inline constexpr uint32_t max_image_extent = 16384;

// Reads the display window of single-part scan line files, uncompressed or RLE, ZIP or PIZ; 16-bit floats are widened. Pixels
// outside of the data window are 0, channels of integers are left out.
ExrFile read_exr(const std::filesystem::path& file);

// Radiance from .hdr or .exr. Negative, infinite and NaN pixels are an error. Adds what has no effect to the notes.
Image read_radiance(const std::filesystem::path& file, std::vector<std::string>& notes);

// Colour from .png, .jpg, .bmp or .tga.
Texture read_texture(const std::filesystem::path& file);

void write_exr(const std::filesystem::path& file, const ExrFile& exr);
void write_hdr(const std::filesystem::path& file, const Image& image);
void write_png(const std::filesystem::path& file, const Texture& image);
void write_jpg(const std::filesystem::path& file, const Texture& image);

// check_writable() for an image.
inline void check_writable(const std::filesystem::path& file) { check_writable(file, {".exr", ".hdr", ".png", ".jpg"}); }

// The sRGB transfer function (IEC 61966-2-1), linear to encoded, clamped to [0,1]. In double, so that bytes survive the round
// trip to linear.
inline float linear_to_srgb(float linear) {
    const double value = std::clamp(static_cast<double>(linear), 0.0, 1.0);
    return static_cast<float>(value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055);
}

}  // namespace lab
