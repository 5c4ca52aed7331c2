// Projects points of the scene into the picture.
#pragma once
#include <array>
#include <optional>

#include "shaders/interface.h"

namespace lab {

// The image position of a point: (0,0) is the upper left corner, (1,1) the lower right one, as in shaders/world/camera.glsl.
// Positions outside lie beside the picture. Empty for points that are not in front of the camera.
std::optional<vec2> project(const Camera& camera, const vec3& point);

// The end points of the part of a segment that is in front of the camera, if there is one.
std::optional<std::array<vec2, 2>> project_segment(const Camera& camera, vec3 from, vec3 to);

}  // namespace lab
