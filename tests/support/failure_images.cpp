#include "support/failure_images.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "files/project_folder.h"
#include "statistics/statistics.h"

namespace lab {
namespace {

Texture blank(uint32_t width, uint32_t height) {
    return {width, height, std::vector<uint8_t>(size_t{4} * width * height, 255)};
}

void set_pixel(Texture& texture, uint32_t x, uint32_t y, const std::array<uint8_t, 3>& colour) {
    std::ranges::copy(colour, &texture.pixels[4 * (size_t{y} * texture.width + x)]);
}

uint8_t encode(float value) { return static_cast<uint8_t>(std::lround(255 * linear_to_srgb(value))); }

void write_both(const std::filesystem::path& folder, const std::string& name, const Image& image) {
    write_exr(folder / (name + ".exr"), {.image = image, .channels = {}, .attributes = {}});
    Texture texture = blank(image.width, image.height);
    for (uint32_t i = 0; i < image.width * image.height; ++i) {
        const float* rgb = &image.pixels[3 * size_t{i}];
        set_pixel(texture, i % image.width, i / image.width,
                  {encode(rgb[0]), encode(rgb[1]), encode(rgb[2])});
    }
    write_png(folder / (name + ".png"), texture);
}

Texture draw_z_map(const ZMap& map) {
    constexpr uint32_t tile = 8;
    Texture texture = blank(tile * map.width, tile * map.height);
    for (uint32_t y = 0; y < texture.height; ++y)
        for (uint32_t x = 0; x < texture.width; ++x)
            set_pixel(texture, x, y, z_colour(map.values[size_t{y / tile} * map.width + x / tile]));
    return texture;
}

Texture draw_histogram(const ZMap& map) {
    constexpr uint32_t bars = 20, bar_width = 12, height = 120;
    std::array<size_t, bars> counts{};
    for (const double z : map.values)
        ++counts[std::min(static_cast<size_t>(normal_p_value(z) * bars), size_t{bars - 1})];
    const size_t highest = *std::max_element(counts.begin(), counts.end());
    Texture texture = blank(bars * bar_width, height);
    for (uint32_t x = 0; x < texture.width; ++x) {
        const uint32_t bar_height = static_cast<uint32_t>(counts[x / bar_width] * height / highest);
        for (uint32_t y = height - bar_height; y < height; ++y) set_pixel(texture, x, y, {51, 51, 51});
    }
    return texture;
}

}  // namespace

void write_failure(const std::string& what, const Image& image, const Image& reference, const ZMap& map) {
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    std::string name =
        std::string(test.test_suite_name()) + "." + test.name() + (what.empty() ? "" : "." + what);
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.') c = '_';
    const auto folder = project_folder() / "output" / "failed" / name;
    std::filesystem::create_directories(folder);
    Image difference = image;
    for (size_t i = 0; i < difference.pixels.size(); ++i) difference.pixels[i] -= reference.pixels[i];
    write_both(folder, "image", image);
    write_both(folder, "reference", reference);
    write_both(folder, "difference", difference);
    write_png(folder / "z_map.png", draw_z_map(map));
    write_png(folder / "p_histogram.png", draw_histogram(map));
    std::printf("  see %s\n", folder.string().c_str());
}

int failed_expectations() {
    return testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
}

}  // namespace lab
