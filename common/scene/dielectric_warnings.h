// Scenes with dielectrics that mean more than chapter 6 computes.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

// One line for each kind: a dielectric that seems to lie inside another one, and an opaque object that seems
// to lie inside absorbing glass. Judged by bounding boxes alone, so what lies in the hole of a torus counts
// as well: the lines say "may". Scenes of more than ten million triangles or pairs of boxes are only looked
// at in part.
std::vector<std::string> dielectric_warnings(const Scene& scene);

}  // namespace lab
