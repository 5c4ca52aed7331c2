// Tables that light samples are drawn from: emissive triangles and the cells of a light probe.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "image/image.h"
#include "scene/scene.h"
#include "shaders/interface.h"

namespace lab {

// Luminance of linear sRGB (ITU-R BT.709).
double get_luminance(const vec3& colour);

// The area of an emissive triangle in world space. A density per area overflows float below 1e-37, so smaller triangles count as
// that large: what they send is too little to be seen.
double light_area(const Scene& scene, uint32_t instance, uint32_t triangle);

struct LightTable {
    // Chosen with probability proportional to area times luminance. Empty if nothing emits.
    std::vector<LightTriangle> triangles;
    // The scene's materials with light_density filled in: luminance over the sum of areas times luminances. So a bounce that hits
    // a light knows the density of its light samples without a search.
    std::vector<Material> materials;
};

// `probability` is that of a light sample choosing the triangles at all; densities include it. Throws UserError for more than
// 2^24 emissive triangles in all instances.
LightTable build_light_table(const Scene& scene, double probability = 1);

// Walker's alias table, built in double by Vose's method (IEEE Transactions on Software Engineering 17(9), 1991), chooses one of
// n items in constant time. 64 random bits choose entry i, so that all are equally probable; the result is item i if 32 further
// bits are below its threshold, else its alias.
struct AliasTable {
    struct Entry {
        uint32_t threshold = 0;
        uint32_t alias = 0;
    };
    std::vector<Entry> entries;
    // Probability of each item, exactly as the table's integers produce it, so that estimators that divide by it are unbiased.
    // They match the weights within 2^-32.
    std::vector<double> probabilities;
};

// Probabilities are proportional to the weights, which are finite, not negative, and not all zero. Only items of weight 0 get
// probability 0.
AliasTable build_alias_table(std::span<const double> weights);

// The cells of a light probe row by row from the top, one per texel (or larger, at most MAX_PROBE_CELL_COLUMNS times _ROWS),
// chosen with probability proportional to solid angle times mean luminance of the filtered probe, so that no bright direction has
// density 0. A black probe gives uniform directions. `probability` as above, but for the probe.
std::vector<ProbeCell> build_probe_table(const Image& probe, double probability = 1);

}  // namespace lab
