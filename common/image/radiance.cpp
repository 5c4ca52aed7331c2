// Reads radiance from .hdr (RGBE) and .exr files.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "files/file.h"
#include "image/image.h"
#include "image/image_checks.h"

namespace lab {
namespace {

// The resolution line "-Y height +X width": rows from the top, pixels from the left.
void read_resolution(const std::filesystem::path& file, std::string_view line, Image& image) {
    const auto number = [&](std::string_view axis, uint32_t& value) {
        if (!line.starts_with(axis)) fail(file, "only .hdr files with rows from the top (-Y, then +X) are read");
        line.remove_prefix(axis.size());
        const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
        if (error != std::errc()) fail(file, "its width and height cannot be read");
        line.remove_prefix(static_cast<size_t>(end - line.data()));
    };
    number("-Y ", image.height);
    number(" +X ", image.width);
    check_image_size(file, image.width, image.height);
}

// Reads a row of four bytes per pixel. Rows of at least 8 pixels that start with 2, 2 and their width are run-length encoded
// channel by channel.
void read_row(const std::filesystem::path& file, std::string_view& bytes, std::vector<uint8_t>& row) {
    const auto next = [&] {
        if (bytes.empty()) fail_truncated(file);
        const auto value = static_cast<uint8_t>(bytes.front());
        bytes.remove_prefix(1);
        return value;
    };
    const size_t width = row.size() / 4;
    const char marker[] = {2, 2, static_cast<char>(width >> 8), static_cast<char>(width & 255)};
    if (width < 8 || !bytes.starts_with({marker, sizeof marker})) {
        std::ranges::generate(row, next);
        return;
    }
    bytes.remove_prefix(sizeof marker);
    for (size_t channel = 0; channel < 4; ++channel) {
        for (size_t x = 0; x < width;) {
            const uint8_t code = next();
            const bool is_run = code > 128;
            const size_t count = is_run ? code - 128u : code;
            if (count == 0 || x + count > width) fail(file, "damaged run-length encoding");
            uint8_t value = is_run ? next() : uint8_t{0};
            for (const size_t end = x + count; x < end; ++x) {
                if (!is_run) value = next();
                row[4 * x + channel] = value;
            }
        }
    }
}

Image read_hdr(const std::filesystem::path& file) {
    const std::string content = read_file(file, max_image_file_bytes);
    if (!content.starts_with("#?")) fail(file, "not a Radiance .hdr file");
    std::string_view bytes = content;
    const auto next_line = [&] { return take_until('\n', file, bytes); };
    for (std::string_view line = next_line(); !line.empty(); line = next_line())
        if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
            fail(file, "only .hdr files of format 32-bit_rle_rgbe are read");

    Image image;
    read_resolution(file, next_line(), image);
    const size_t pixel_count = static_cast<size_t>(image.width) * image.height;
    // A run of 127 equal values takes two bytes in each of the four channels.
    if (pixel_count > 16 * content.size()) fail_truncated(file);
    check_memory(file, 3 * pixel_count * sizeof(float), content.size());
    image.pixels.reserve(3 * pixel_count);
    std::vector<uint8_t> row(4 * size_t{image.width});
    for (uint32_t y = 0; y < image.height; ++y) {
        read_row(file, bytes, row);
        for (size_t x = 0; x < image.width; ++x) {
            const int exponent = row[4 * x + 3];  // shared by the three mantissas; 0 is black
            for (size_t channel = 0; channel < 3; ++channel)
                image.pixels.push_back(exponent ? std::ldexp(static_cast<float>(row[4 * x + channel]), exponent - 136) : 0.0f);
        }
    }
    return image;
}

}  // namespace

Image read_radiance(const std::filesystem::path& file) {
    const std::string extension = lower_case_extension(file);
    if (extension != ".hdr" && extension != ".exr") fail(file, "a light probe must be a .hdr or .exr file");
    Image image = extension == ".hdr" ? read_hdr(file) : read_exr(file).image;
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        if (image.pixels[i] >= 0 && std::isfinite(image.pixels[i])) continue;
        const size_t pixel = i / 3;
        fail(file, "pixel (" + std::to_string(pixel % image.width) + ", " + std::to_string(pixel / image.width) +
                       ") is negative, infinite or not a number");
    }
    return image;
}

}  // namespace lab
