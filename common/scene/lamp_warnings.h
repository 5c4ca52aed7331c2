// Warns about lamps that light nothing.
#pragma once
#include "scene/scene.h"

namespace lab {

// One line if all lamps face away from the camera and from everything in the scene: then the picture is black.
std::vector<std::string> lamp_warnings(const Scene& scene);

}  // namespace lab
