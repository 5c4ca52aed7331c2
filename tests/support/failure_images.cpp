#include "support/failure_images.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cstdio>
#include <filesystem>

#include "files/project_folder.h"

namespace lab {

void write_failure(const std::string& what, const Image& image, const Image& reference, const ZMap& map) {
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test.test_suite_name()) + "." + test.name() + (what.empty() ? "" : "." + what);
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.') c = '_';
    const auto folder = project_folder() / "output" / "failed" / name;
    std::filesystem::create_directories(folder);
    Image difference = image;
    for (size_t i = 0; i < difference.pixels.size(); ++i) difference.pixels[i] -= reference.pixels[i];
    for (const auto& [file, contents] :
         {std::pair{"image.exr", &image}, {"reference.exr", &reference}, {"difference.exr", &difference}})
        write_exr(folder / file, {.image = *contents, .channels = {}, .attributes = {}});
    Texture z_map{map.width, map.height, {}};
    for (const double z : map.values) {
        const std::array<uint8_t, 3> colour = z_colour(z);
        z_map.pixels.insert(z_map.pixels.end(), {colour[0], colour[1], colour[2], 255});
    }
    write_png(folder / "z_map.png", z_map);
    std::printf("  see %s\n", folder.string().c_str());
}

int failed_expectations() { return testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count(); }

}  // namespace lab
