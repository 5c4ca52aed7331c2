// Mesh files to the arrays of a Scene.
#pragma once
#include <vector>

#include "scene/obj_file.h"
#include "scene/scene.h"

namespace lab {

// Fills the scene's vertices, triangles, materials, textures and meshes (one a file). Corners with the same
// position, normal and texture coordinates become one vertex; triangles without area are left out, and so are
// materials without triangles. Calls resolve_coincident_lights() for each mesh. Reads the textures. UserError
// for damaged textures and for files in which no triangle has an area. Returns the line of its file for each
// of the scene's triangles.
std::vector<uint32_t> assemble_meshes(const std::vector<ObjFile>& files, bool specular, SourceFiles& sources,
                                      Scene& scene);

}  // namespace lab
