// Which medium is on which side of the surfaces.
#pragma once
#include "scene/scene_file.h"

namespace lab {

// Fills the scene's media and boundaries, once its meshes are placed; does nothing if none has a medium and there is no fog.
// Nested meshes work. Throws UserError for a medium behind a surface that nothing gets through, or behind absorbing glass.
void add_media(const SceneDescription& description, Scene& scene);

}  // namespace lab
