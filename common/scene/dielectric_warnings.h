// Scenes with dielectrics that mean more than chapter 6 computes.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

// One line for each kind: a dielectric that seems to lie inside another one, an opaque object that seems to
// lie inside absorbing glass, one that reaches into it, and glass whose surface is not closed. What lies
// inside is judged by bounding boxes alone, so that what lies in the hole of a torus counts as well: the
// lines say "may". Scenes of more than ten million triangles or pairs are only looked at in part, and glass
// of more than a million triangles counts as closed.
std::vector<std::string> dielectric_warnings(const Scene& scene);

}  // namespace lab
