// Triangulates polygons.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "shaders/interface.h"

namespace lab {

// Cuts n >= 3 nearly coplanar corners into n - 2 triangles of indices into `polygon`, with its winding. Convex polygons become a
// fan around corner 0, concave ones are cut by ear clipping; self-intersecting polygons also give triangles. Takes O(n^3) steps
// at worst.
std::vector<std::array<uint32_t, 3>> triangulate(std::span<const vec3> polygon);

}  // namespace lab
