// All emissive triangles of a scene, for next event estimation.
#pragma once
#include <vector>

#include "scene/scene.h"

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

}  // namespace lab
