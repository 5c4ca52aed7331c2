// Triangles in the same place of which one emits: rays find either.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

// Where a triangle is, and which way it faces.
struct Place {
    std::array<std::array<float, 3>, 3> corners;  // in the world, in ascending order
    bool is_turned;                               // tells the triangle's front from its back
    auto operator<=>(const Place&) const = default;
};
Place get_place(const Scene& scene, const Instance& instance, uint32_t triangle);

// Gives the scene's last triangles, those of a mesh that is being added, one meaning. `lines` are those of
// its file. Where an opaque triangle emits and others of the mesh are in the same place, the first that emits
// stays of those that face the same way; the others are left out with a warning. Two that face opposite ways
// become a double-sided sheet.
void resolve_coincident_lights(Scene& scene, Mesh& mesh, std::vector<uint32_t>& lines);

// One line if what remains is left to chance: an emissive triangle in the same place as one of another
// instance that differs in emission or faces the other way, or as a dielectric one. `lines` has one for each
// triangle. Scenes of more than ten million triangles are only looked at in part.
std::vector<std::string> coincident_light_warnings(const Scene& scene, const std::vector<uint32_t>& lines);

}  // namespace lab
