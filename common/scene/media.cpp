#include "scene/media.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "error.h"
#include "scene/density_grid.h"

namespace lab {
namespace {

using glm::dvec3;

// The solid angle of a triangle seen from the origin, with a sign (van Oosterom and Strackee 1983).
double solid_angle(const dvec3& a, const dvec3& b, const dvec3& c) {
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    return 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                          la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

// Whether a closed instance is wound around a point. Mirrored instances are wound the other way.
bool encloses(const Scene& scene, uint32_t instance, const dvec3& point) {
    double sum = 0;
    for (const uint32_t triangle : scene.mesh_of(instance).triangles()) {
        const auto corner = [&](int i) { return world_corner(scene, instance, triangle, i) - point; };
        sum += solid_angle(corner(0), corner(1), corner(2));
    }
    return std::abs(sum) > 2 * std::numbers::pi;
}

// Throws UserError if light cannot get into a medium, or would be dimmed there in two ways.
void check_surface(const MeshPlacement& placement, const Scene& scene, const Mesh& mesh) {
    const auto refuse = [&](const char* why) { throw UserError(placement.file.string() + ": its medium " + why); };
    if (!placement.is_open && mesh.dielectric_count == 0)
        refuse("lies behind an opaque surface: make it glass (d 0), or its \"boundary\" \"open\"");
    for (const uint32_t triangle : mesh.triangles()) {
        const Material& material = scene.material_of(triangle);
        if (placement.is_open && material.emission != vec3(0)) refuse("has an open boundary, which cannot emit: remove Ke");
        if (!placement.is_open && material.absorption != vec3(0)) refuse("lies in absorbing glass: remove Tf, or the medium");
    }
}

// A ray takes about as many steps through a grid as its densest cell would take free flights along the box's diagonal.
// A sample crosses the box up to twice a bounce, and must not look like one that never ends (limited_loops.glsl).
constexpr double max_steps = 3e3;

// Adds a medium with its grid, and returns its index.
uint32_t add_medium(const MediumDescription& description, SourceFiles& files, Scene& scene) {
    Medium medium = description.medium;
    if (!description.density.empty()) {
        const DensityGrid grid = read_density_grid(description.density, files);
        medium.largest_density = *std::ranges::max_element(grid.densities);
        if (double{medium.extinction} * medium.largest_density * glm::distance(dvec3(medium.low), dvec3(medium.high)) > max_steps)
            throw UserError(
                description.density.string() +
                ": at its largest density a ray would collide more than 3000 times in its box: lower the \"extinction\"");
        if (medium.largest_density == 0) medium.extinction = 0;
        if (medium.extinction > 0) {
            medium.grid_size = grid.size;
            medium.first_density = static_cast<uint32_t>(scene.densities.size());
            scene.densities.insert(scene.densities.end(), grid.densities.begin(), grid.densities.end());
            if (scene.densities.size() > max_density_cells) throw UserError("its grids have too many cells together");
        }
    }
    scene.media.push_back(medium);
    return static_cast<uint32_t>(scene.media.size() - 1);
}

}  // namespace

void add_media(const SceneDescription& description, SourceFiles& files, Scene& scene) {
    const auto& placements = description.meshes;
    if (!description.fog && std::ranges::none_of(placements, [](const auto& placement) { return placement.medium.has_value(); }))
        return;
    add_medium(description.fog.value_or(MediumDescription{}), files, scene);
    const auto count = static_cast<uint32_t>(placements.size());
    scene.boundaries.assign(count, {BOUNDARY_NONE, 0, 0});
    for (uint32_t i = 0; i < count; ++i) {
        const Mesh& mesh = scene.mesh_of(i);
        if (placements[i].medium) check_surface(placements[i], scene, mesh);
        if (!placements[i].medium && mesh.dielectric_count == 0) continue;
        scene.boundaries[i] = {placements[i].is_open ? BOUNDARY_OPEN : BOUNDARY_GLASS,
                               add_medium(placements[i].medium.value_or(MediumDescription{}), files, scene), 0};
    }
    // Outside of a boundary is the innermost of those that enclose it: the one that most others enclose.
    std::vector<std::vector<uint32_t>> around(count);
    for (uint32_t i = 0; i < count; ++i)
        for (uint32_t j = 0; j < count && scene.boundaries[i].kind != BOUNDARY_NONE; ++j)
            if (i != j && scene.boundaries[j].kind != BOUNDARY_NONE &&
                encloses(scene, j, world_corner(scene, i, scene.mesh_of(i).first_triangle, 0)))
                around[i].push_back(j);
    for (uint32_t i = 0; i < count; ++i)
        if (!around[i].empty())
            scene.boundaries[i].outside =
                scene.boundaries[std::ranges::max(around[i], {}, [&](uint32_t j) { return around[j].size(); })].inside;
    if (std::ranges::all_of(scene.boundaries, [](const Boundary& boundary) { return boundary.kind == BOUNDARY_NONE; }))
        scene.boundaries.clear();
}

}  // namespace lab
