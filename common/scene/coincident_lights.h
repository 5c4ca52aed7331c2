// Finds coincident triangles one of which emits: which one a ray hits would be left to chance.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

// Position and orientation of a triangle.
struct Place {
    std::array<std::array<float, 3>, 3> corners;  // world space, in ascending order
    bool is_turned;                               // front and back are exchanged
    auto operator<=>(const Place&) const = default;
};
Place get_place(const Scene& scene, const Instance& instance, uint32_t triangle);

// Resolves coincident lights in the mesh being added, the scene's last triangles, which come from these lines of its file. Of
// opaque triangles that coincide and face the same way, the first emissive one stays, and a warning names those left out. Two
// that face opposite ways become a double-sided sheet.
void resolve_coincident_lights(Scene& scene, Mesh& mesh, std::vector<uint32_t>& lines);

}  // namespace lab
