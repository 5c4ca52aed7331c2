// Which medium is on which side of the surfaces.
#pragma once
#include "scene/bodies.h"
#include "scene/scene_file.h"

namespace lab {

// Nests the bodies and fills the scene's media and boundaries; does nothing if none has a medium and there is no fog. Reads the
// grids of densities. Throws UserError for a medium behind a surface that nothing gets through, or behind absorbing glass, and
// for a grid so dense that rays would take too many steps through it.
void add_media(const SceneDescription& description, std::vector<Body>& bodies, SourceFiles& files, Scene& scene);

// The last step: medium i + 1 fills body i, and medium 0 lies outside of all bodies. Bodies that cavities are have the medium
// around their glass.
void place_media(Scene& scene, const std::vector<Body>& bodies, const Medium& outside, const std::vector<Medium>& media);

// Takes meshes with open boundaries away, for chapters without media: they are no surfaces.
void leave_out_open_boundaries(Scene& scene);

}  // namespace lab
