// What users are told of a scene that is read: what it probably does not mean, or means more than is
// computed.
#pragma once
#include "scene/scene.h"

namespace lab {

// One line for each kind: a dielectric that seems to lie inside another one, an opaque object that seems to
// lie inside absorbing glass, one that reaches into it, and glass whose surface is not closed. What lies
// inside is judged by bounding boxes alone, so that what lies in the hole of a torus counts as well: the
// lines say "may". Scenes of more than ten million triangles or pairs are only looked at in part, and glass
// of more than a million triangles counts as closed.
std::vector<std::string> dielectric_warnings(const Scene& scene);

// One line each where 32-bit numbers are too coarse:
// - for each mesh with texture coordinates so far from 0 that neighbouring floats are more than a texel of
//   their texture apart;
// - if the scene lies so far from the origin that the offset of rays from the surfaces they start from is
//   more than 1/1000 of the scene's size: shadows in corners and between objects that touch are lost then;
// - if the rounding of directions is more than a tenth of a pixel.
std::vector<std::string> precision_warnings(const Scene& scene);

}  // namespace lab
