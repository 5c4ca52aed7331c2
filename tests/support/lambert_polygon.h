// Irradiance from a polygon in closed form: the reference for direct light.
#pragma once
#include <glm/glm.hpp>
#include <vector>

namespace lab {

// Irradiance at a point with this unit normal from a planar polygon of at least three corners that emits radiance 1 from its
// front, where the corners run counter-clockwise, and nothing from its back. What lies below the horizon is cut off. Relative
// error about 1e-10, even for polygons of 10^-6 times their distance. Lambert, "Photometria", 1760.
double polygon_irradiance(const std::vector<glm::dvec3>& corners, const glm::dvec3& point, const glm::dvec3& normal);

}  // namespace lab
