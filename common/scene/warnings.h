// Warnings about a scene: what its author probably did not intend, or what the renderer cannot compute.
#pragma once
#include "scene/bodies.h"

namespace lab {

// One line per kind: a dielectric that may lie inside another, an opaque object that may lie inside absorbing glass (both judged
// by bounding boxes), and glass whose surface is not closed. Examines the first ten million triangles and pairs only.
std::vector<std::string> dielectric_warnings(const Scene& scene, const std::vector<Body>& bodies);

// One line each where 32-bit numbers are too coarse:
// - for each mesh whose texture coordinates are so large that neighbouring floats are more than a texel apart;
// - if the scene is so far from the origin that rays start more than 1/1000 of its size off the surface, which loses shadows in
//   corners;
// - if directions are rounded by more than a tenth of a pixel.
std::vector<std::string> precision_warnings(const Scene& scene);

}  // namespace lab
