// Surfaces that lie in one place.
#pragma once
#include "scene/bodies.h"

namespace lab {

// Which of two surfaces in one plane a ray meets, and whether it meets both, depends on rounding. So one of them moves by some
// units in the last place, far enough for all backends to tell them apart: glass and the ends of media move inwards, the smaller
// body if two of them touch; a lamp moves to its front; and of two that face the same way, the later one in the file. A note
// names those whose picture depends on that.
void separate_contacts(Scene& scene, std::vector<Body>& bodies);

}  // namespace lab
