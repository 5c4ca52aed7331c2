// All emissive triangles of a scene, for next event estimation.
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
    // Chosen with probability proportional to area times luminance of the emission. Empty if nothing emits.
    std::vector<LightTriangle> triangles;
    // The scene's, with their light_density: luminance over the sum of all areas times luminances. Whoever
    // finds a light knows the density of its light samples without a search through the table.
    std::vector<Material> materials;
};

// `probability`: that a light sample goes to the triangles at all; the densities hold it.
// Throws UserError if the instances have more than 2^24 emissive triangles together.
LightTable build_light_table(const Scene& scene, double probability = 1);

// Walker's alias table, built by Vose's method (IEEE Transactions on Software Engineering 17(9), 1991) in
// double. To choose an item take two random 32-bit words: entry i is the high word of word_1 * n; the item is
// i itself if word_2 < threshold of i, else alias of i.
struct AliasTable {
    struct Entry {
        uint32_t threshold = 0;
        uint32_t alias = 0;
    };
    std::vector<Entry> entries;
    // Of each item, exactly as the table's integers make them. The weights are met up to 2^-32: estimators
    // that divide by these probabilities stay unbiased.
    std::vector<double> probabilities;
};

// Probabilities are proportional to the weights, which must be finite and not negative, at least one
// positive. An item of weight 0 is never chosen, one of positive weight always has a positive probability.
AliasTable build_alias_table(std::span<const double> weights);

// Cells row by row from the top, one a texel (larger ones where MAX_PROBE_CELL_COLUMNS or _ROWS is exceeded),
// chosen with probability proportional to the mean luminance of the filtered probe times the solid angle. So
// each cell in which anything shines has a positive probability. A black probe has uniform directions.
// `probability`: that a light sample goes to the probe at all; the densities hold it.
std::vector<ProbeCell> build_probe_table(const Image& probe, double probability = 1);

}  // namespace lab
