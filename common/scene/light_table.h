// Tables to choose light samples from: emissive triangles and the cells of a light probe.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "image/image.h"
#include "scene/scene.h"
#include "shaders/interface.h"

namespace lab {

// Of linear sRGB (ITU-R BT.709).
double get_luminance(const vec3& colour);

struct LightTable {
    // Chosen with probability proportional to area times luminance. Empty if nothing emits.
    std::vector<LightTriangle> triangles;
    // The scene's, with light_density: luminance over the sum of areas times luminances. So bounces that hit a light know the
    // density of its light samples without a search.
    std::vector<Material> materials;
};

// `probability` is that of a light sample going to the triangles at all; densities include it. Throws UserError for more than
// 2^24 emissive triangles in all instances.
LightTable build_light_table(const Scene& scene, double probability = 1);

// Walker's alias table, built by Vose's method (IEEE Transactions on Software Engineering 17(9), 1991) in double, chooses one of
// n items in constant time. An entry i is chosen by 64 random digits, so that all are equally probable; the item is i if 32
// further digits are below its threshold, else its alias.
struct AliasTable {
    struct Entry {
        uint32_t threshold = 0;
        uint32_t alias = 0;
    };
    std::vector<Entry> entries;
    // Of each item, exactly as the table's integers make them, so that estimators that divide by them are unbiased. They match
    // the weights up to 2^-32.
    std::vector<double> probabilities;
};

// Probabilities are proportional to the weights: finite, not negative, at least one positive. Only items of weight 0 have
// probability 0.
AliasTable build_alias_table(std::span<const double> weights);

// The cells of a light probe row by row from the top, one per texel (or larger, at most MAX_PROBE_CELL_COLUMNS times _ROWS),
// chosen with probability proportional to solid angle times mean luminance of the filtered probe, so that no bright direction has
// density 0. A black probe gives uniform directions. `probability` as above, for the probe.
std::vector<ProbeCell> build_probe_table(const Image& probe, double probability = 1);

}  // namespace lab
