// The scene of the traversal benchmark: a Cornell box with a bumpy sphere of any number of triangles.
#pragma once
#include "scene/scene.h"

namespace lab {

// Ten triangles for the box, 2 light_cells² for its light, 2 segments (rings - 1) for the sphere.
Scene make_box_scene(uint32_t segments, uint32_t rings, uint32_t light_cells = 1);

}  // namespace lab
