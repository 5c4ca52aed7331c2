// Reads radiance from .hdr (RGBE) and .exr files.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "files/file.h"
#include "image/image.h"
#include "image/image_checks.h"

namespace lab {
namespace {

// A line of the header, whatever system wrote it.
std::string_view take_line(const std::filesystem::path& file, std::string_view& bytes) {
    std::string_view line = take_until('\n', file, bytes);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

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

// The numbers behind the "=" of a line of the header.
template <size_t count>
std::array<float, count> read_numbers(const std::filesystem::path& file, std::string_view line) {
    const std::string_view keyword = line.substr(0, line.find('='));
    line.remove_prefix(keyword.size() + 1);
    std::array<float, count> numbers;
    for (float& number : numbers) {
        line.remove_prefix(std::min(line.find_first_not_of(" \t+"), line.size()));
        const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
        if (error != std::errc()) fail(file, "its " + std::string(keyword) + " needs " + std::to_string(count) + " numbers");
        line.remove_prefix(static_cast<size_t>(end - line.data()));
    }
    return numbers;
}

struct HdrHeader {
    std::array<double, 3> exposure{1, 1, 1};  // that the pixels have been multiplied by
    bool has_other_primaries = false;
};

HdrHeader read_header(const std::filesystem::path& file, std::string_view& bytes) {
    HdrHeader header;
    const auto expose = [&](const std::array<float, 3>& factors) {
        for (size_t channel = 0; channel < 3; ++channel) header.exposure[channel] *= double{factors[channel]};
    };
    for (std::string_view line = take_line(file, bytes); !line.empty(); line = take_line(file, bytes)) {
        if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
            fail(file, "only .hdr files of format 32-bit_rle_rgbe are read");
        if (line.starts_with("COLORCORR=")) expose(read_numbers<3>(file, line));
        if (line.starts_with("EXPOSURE=")) {
            const float factor = read_numbers<1>(file, line)[0];
            expose({factor, factor, factor});
        }
        if (line.starts_with("PRIMARIES=")) header.has_other_primaries = !are_primaries_of_srgb(read_numbers<8>(file, line));
    }
    if (!std::ranges::all_of(header.exposure, [](double factor) { return factor > 0 && std::isfinite(factor); }))
        fail(file, "EXPOSURE and COLORCORR must be above 0 and finite");
    return header;
}

// Reads pixels of four bytes. The pixel 1, 1, 1, n repeats the one before it n times; in each further one that follows at once,
// n counts 256 times as much (Radiance's encoding before 1991).
void read_pixels(const std::filesystem::path& file, std::string_view& bytes, std::vector<uint8_t>& row) {
    size_t place = 1;  // value of n
    for (size_t i = 0; i < row.size();) {
        if (bytes.size() < 4) fail_truncated(file);
        const std::string_view pixel = bytes.substr(0, 4);
        bytes.remove_prefix(4);
        if (!pixel.starts_with("\1\1\1")) {
            for (const char byte : pixel) row[i++] = static_cast<uint8_t>(byte);
            place = 1;
            continue;
        }
        const size_t count = static_cast<uint8_t>(pixel[3]) * place;
        if (i == 0 || count > (row.size() - i) / 4) fail(file, "damaged run-length encoding");
        for (const size_t end = i + 4 * count; i < end; ++i) row[i] = row[i - 4];
        place = std::min(place * 256, size_t{max_image_extent} + 1);
    }
}

// Reads a row of four bytes per pixel. Rows of at least 8 pixels that start with 2, 2 and their width are run-length encoded
// channel by channel.
void read_row(const std::filesystem::path& file, std::string_view& bytes, std::vector<uint8_t>& row) {
    const size_t width = row.size() / 4;
    const char marker[] = {2, 2, static_cast<char>(width >> 8), static_cast<char>(width & 255)};
    if (width < 8 || !bytes.starts_with({marker, sizeof marker})) {
        return read_pixels(file, bytes, row);
    }
    bytes.remove_prefix(sizeof marker);
    const auto next = [&] {
        if (bytes.empty()) fail_truncated(file);
        const auto value = static_cast<uint8_t>(bytes.front());
        bytes.remove_prefix(1);
        return value;
    };
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

Image read_hdr(const std::filesystem::path& file, bool& has_other_primaries) {
    const std::string content = read_file(file, max_image_file_bytes);
    if (!content.starts_with("#?")) fail(file, "not a Radiance .hdr file");
    std::string_view bytes = content;
    const HdrHeader header = read_header(file, bytes);
    has_other_primaries = header.has_other_primaries;

    Image image;
    read_resolution(file, take_line(file, bytes), image);
    const size_t pixel_count = static_cast<size_t>(image.width) * image.height;
    if (4 * size_t{image.height} > content.size()) fail_truncated(file);  // a row takes at least a pixel
    check_memory(file, 3 * pixel_count * sizeof(float), content.size());
    image.pixels.reserve(3 * pixel_count);
    std::vector<uint8_t> row(4 * size_t{image.width});
    for (uint32_t y = 0; y < image.height; ++y) {
        read_row(file, bytes, row);
        for (size_t x = 0; x < image.width; ++x) {
            const int exponent = row[4 * x + 3];  // shared by the three mantissas; 0 is black
            for (size_t channel = 0; channel < 3; ++channel)
                image.pixels.push_back(static_cast<float>(
                    exponent ? std::ldexp(static_cast<double>(row[4 * x + channel]), exponent - 136) / header.exposure[channel]
                             : 0));
        }
    }
    return image;
}

}  // namespace

Image read_radiance(const std::filesystem::path& file, std::vector<std::string>& notes) {
    const std::string extension = lower_case_extension(file);
    if (extension != ".hdr" && extension != ".exr") fail(file, "a light probe must be a .hdr or .exr file");
    Image image;
    bool has_other_primaries = false;
    if (extension == ".hdr") {
        image = read_hdr(file, has_other_primaries);
    } else {
        ExrFile exr = read_exr(file);
        image = std::move(exr.image);
        has_other_primaries = exr.has_other_primaries;
    }
    if (has_other_primaries)
        notes.push_back(printable(file.string()) + ": its primaries are not those of sRGB: its colours are used as if they were");
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        if (image.pixels[i] >= 0 && std::isfinite(image.pixels[i])) continue;
        const size_t pixel = i / 3;
        fail(file, "pixel (" + std::to_string(pixel % image.width) + ", " + std::to_string(pixel / image.width) +
                       ") is negative, infinite or not a number");
    }
    return image;
}

}  // namespace lab
