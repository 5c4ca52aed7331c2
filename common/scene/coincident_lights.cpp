#include "scene/coincident_lights.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace lab {
namespace {

using Corners = std::array<std::array<float, 3>, 3>;

bool is_emissive(const Scene& scene, uint32_t triangle) { return scene.material_of(triangle).emission != vec3(0); }

// Rotates the second triangle's corners to start at the first triangle's first corner, so that a point has the same barycentric
// coordinates in both, but swapped.
void align(Scene& scene, uint32_t first, uint32_t second) {
    uvec3& corners = scene.triangles[second];
    while (scene.corner(second, 0) != scene.corner(first, 0)) corners = uvec3(corners.y, corners.z, corners.x);
}

// A triangle in the same place as an emissive one, ordered by preference.
struct Candidate {
    Place place;
    bool is_dark;
    uint32_t triangle;
    auto operator<=>(const Candidate&) const = default;
};

}  // namespace

Place get_place(const Scene& scene, const Instance& instance, uint32_t triangle) {
    Place place;
    for (int i = 0; i < 3; ++i) {
        const vec3 corner = instance.object_to_world * glm::vec4(scene.corner(triangle, i), 1);
        place.corners[i] = {corner.x + 0.0f, corner.y + 0.0f, corner.z + 0.0f};  // adding 0 removes negative zeros
    }
    place.is_turned = glm::determinant(glm::dmat3(mat3(instance.object_to_world))) < 0;
    const auto order = [&](size_t a, size_t b) {
        if (place.corners[a] <= place.corners[b]) return;
        std::swap(place.corners[a], place.corners[b]);
        place.is_turned = !place.is_turned;
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    return place;
}

void resolve_coincident_lights(Scene& scene, Mesh& mesh, std::vector<uint32_t>& lines) {
    const Instance as_it_is{mat4x3(1), mat3(1)};
    const uint32_t first = mesh.first_triangle, end = first + mesh.triangle_count - mesh.dielectric_count;
    std::vector<Corners> lights;
    for (uint32_t i = first; i < end; ++i)
        if (is_emissive(scene, i)) lights.push_back(get_place(scene, as_it_is, i).corners);
    if (lights.empty()) return;
    std::sort(lights.begin(), lights.end());
    std::vector<Candidate> places;
    for (uint32_t i = first; i < end; ++i) {
        const Place place = get_place(scene, as_it_is, i);
        if (std::binary_search(lights.begin(), lights.end(), place.corners)) places.push_back({place, !is_emissive(scene, i), i});
    }
    std::sort(places.begin(), places.end());

    std::vector<bool> is_left_out(mesh.triangle_count);
    std::pair<uint32_t, uint32_t> first_left_out{UINT32_MAX, 0};  // and the one that stays
    size_t kept = 0;
    for (size_t i = 1; i < places.size(); ++i) {
        if (places[i].place == places[kept].place) {
            is_left_out[places[i].triangle - first] = true;
            first_left_out = std::min(first_left_out, {places[i].triangle, places[kept].triangle});
        } else {
            places[++kept] = places[i];
        }
    }
    const size_t others = places.size() - kept - 2;  // also left out
    if (kept + 1 < places.size()) {
        const auto [triangle, other] = first_left_out;
        scene.warnings.push_back(mesh.file + ":" + std::to_string(lines[triangle - first]) + ": lies in the same place as line " +
                                 std::to_string(lines[other - first]) + ", faces the same way, and one of them emits: left out" +
                                 (others > 0 ? ", as " + std::to_string(others) + " others" : ""));
    }
    places.resize(kept + 1);

    std::vector<uint32_t> moved(mesh.triangle_count);  // new indices of the remaining triangles
    uint32_t count = 0;
    for (uint32_t i = 0; i < mesh.triangle_count; ++i) {
        moved[i] = first + count;
        if (is_left_out[i]) continue;
        scene.triangles[first + count] = scene.triangles[first + i];
        scene.triangle_materials[first + count] = scene.triangle_materials[first + i];
        lines[count++] = lines[i];
    }
    mesh.triangle_count = count;
    scene.triangles.resize(first + count);
    scene.triangle_materials.resize(first + count);
    lines.resize(count);

    for (size_t i = 1; i < places.size(); ++i) {
        if (places[i].place.corners != places[i - 1].place.corners) continue;
        const uint32_t a = moved[places[i - 1].triangle - first], b = moved[places[i].triangle - first];
        align(scene, a, b);
        scene.double_sided.emplace_back(a, b);
    }
}

}  // namespace lab
