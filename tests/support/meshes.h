// Meshes made in memory, and scenes of instances of them.
#pragma once
#include <filesystem>
#include <vector>

#include "scene/scene.h"

namespace lab {

struct TriangleMesh {
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
};

// A closed sphere of about unit radius with 2 * rings * (rings - 1) triangles whose surface is not smooth.
TriangleMesh bumpy_sphere(uint32_t rings);

// A scene of that mesh under a white sky, seen from +Z, with no instance yet; of no mesh if it has no
// triangles.
Scene lit_scene(const TriangleMesh& mesh);

// Adds an instance of the scene's mesh.
void place(Scene& scene, const mat4x3& object_to_world);

// Files and folders of a folder in the order of their names.
std::vector<std::filesystem::path> sorted_entries(const std::filesystem::path& folder);

}  // namespace lab
