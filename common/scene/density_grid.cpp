#include "scene/density_grid.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "error.h"

namespace lab {
namespace {

// "VOL", the version, and then numbers of 32 bits, the lowest byte first: the type, the size, the number of channels, the box.
struct Header {
    char magic[4];
    int32_t type, x, y, z, channels;
    float box[6];
};
constexpr int32_t type_float = 1;

}  // namespace

DensityGrid read_density_grid(const std::filesystem::path& file, SourceFiles& files) {
    static_assert(std::endian::native == std::endian::little);
    const auto refuse = [&](const std::string& why) { throw UserError(file.string() + ": " + why); };
    const std::string bytes = files.read(file, sizeof(Header) + max_density_cells * sizeof(float));
    Header header;
    if (bytes.size() < sizeof header) refuse("is too short for a grid of densities");
    std::memcpy(&header, bytes.data(), sizeof header);
    if (std::memcmp(header.magic, "VOL\3", 4) != 0) refuse("is no grid of densities: these start with \"VOL\" and the version 3");
    if (header.type != type_float || header.channels != 1) refuse("must hold one channel of 32-bit numbers");
    const uvec3 size(header.x, header.y, header.z);
    uint64_t cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
        if (size[axis] == 0 || size[axis] > max_density_cells) refuse("has an impossible size");
        cells *= size[axis];
        if (cells > max_density_cells) refuse("has more than " + std::to_string(max_density_cells) + " cells");
    }
    if (bytes.size() != sizeof header + cells * sizeof(float))
        refuse("ends " + std::string(bytes.size() < sizeof header + cells * sizeof(float) ? "early" : "late") +
               ": it should have " + std::to_string(cells) + " cells");
    DensityGrid grid{size, std::vector<float>(cells)};
    std::memcpy(grid.densities.data(), bytes.data() + sizeof header, cells * sizeof(float));
    for (uint64_t i = 0; i < cells; ++i)
        if (!(grid.densities[i] >= 0) || !std::isfinite(grid.densities[i]))
            refuse("its cell " + std::to_string(i) + " is negative or not finite");
    return grid;
}

}  // namespace lab
