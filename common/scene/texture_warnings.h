// Texture coordinates that floats cannot hold exactly enough.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

// One line for each mesh whose coordinates are so far from 0 that neighbouring floats are more than a texel
// of their texture apart.
std::vector<std::string> texture_warnings(const Scene& scene);

}  // namespace lab
