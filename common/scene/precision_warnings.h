// Scenes whose coordinates 32-bit numbers hold too coarsely.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

// One line each where
// - the scene lies so far from the origin that the offset of rays from the surfaces they start from is more
//   than 1/1000 of the scene's size: shadows in corners and between objects that touch are lost then;
// - the rounding of directions is more than a tenth of a pixel.
std::vector<std::string> precision_warnings(const Scene& scene);

}  // namespace lab
