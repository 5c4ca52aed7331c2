// Grids of densities, in the format of Mitsuba's volumes.
#pragma once
#include <filesystem>
#include <vector>

#include "scene/text_lines.h"
#include "shaders/interface.h"

namespace lab {

inline constexpr uint64_t max_density_cells = uint64_t{1} << 25;  // what the smallest device accepts as a buffer, 128 MiB

struct DensityGrid {
    uvec3 size;                    // cells along each axis, at least one
    std::vector<float> densities;  // finite and not negative, x fastest
};

// Throws UserError for anything but a .vol file of version 3 that holds 32-bit numbers in one channel. The box in it is not used.
DensityGrid read_density_grid(const std::filesystem::path& file, SourceFiles& files);

}  // namespace lab
