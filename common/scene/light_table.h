// All emissive triangles of a scene, for next event estimation.
#pragma once
#include <vector>

#include "scene/scene.h"

namespace lab {

// Chosen with probability proportional to area times luminance of the emission. Empty if nothing emits.
// Throws UserError if the instances have more than 2^24 emissive triangles together.
std::vector<LightTriangle> build_light_table(const Scene& scene);

}  // namespace lab
