// Where points of the scene are in the picture.
#pragma once
#include <array>
#include <optional>

#include "shaders/interface.h"

namespace lab {

// Image position, (0,0) at the upper left corner and (1,1) at the lower right one, as in shaders/world/camera.glsl; outside of
// that the point is beside the picture. None for points that are not in front of the camera.
std::optional<vec2> project(const Camera& camera, const vec3& point);

// The ends of the part of a segment that is in front of the camera, if any is.
std::optional<std::array<vec2, 2>> project_segment(const Camera& camera, vec3 from, vec3 to);

}  // namespace lab
