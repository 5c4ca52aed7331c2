// Which medium is on which side of the surfaces.
#pragma once
#include "scene/scene_file.h"

namespace lab {

// Fills the scene's media and boundaries, once its meshes are placed; does nothing if none has a medium and there is no fog.
// Nested meshes work. Reads the grids of densities. Throws UserError for a medium behind a surface that nothing gets through, or
// behind absorbing glass, and for a grid so dense that rays would take too many steps through it.
void add_media(const SceneDescription& description, SourceFiles& files, Scene& scene);

}  // namespace lab
