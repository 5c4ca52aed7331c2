// Scenes with dielectrics, made in memory.
#pragma once
#include <vector>

#include "support/scenes.h"

namespace lab {

// A smooth dielectric that absorbs `absorption` per unit of length.
Material dielectric_material(float refractive_index, const vec3& absorption = vec3(0));

// A closed room [-1,1]³ with a large lamp under its ceiling, seen from inside; it contains a box of the material, or nothing.
Scene room_with_box(const Material& box, const vec3& low = {-0.5f, -0.8f, -0.6f}, const vec3& high = {0.3f, 0.1f, 0.2f});
Scene empty_room();

// A box of the material that fills the view and contains a lamp above a floor, under a dim sky.
Scene glass_with_lamp(const Material& glass);

}  // namespace lab
