#include "scene/media.h"

#include <algorithm>

#include "error.h"
#include "scene/density_grid.h"
#include "scene/pairs.h"

namespace lab {
namespace {

using glm::dvec3;

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

// A medium with its grid.
Medium make_medium(const MediumDescription& description, SourceFiles& files, Scene& scene) {
    Medium medium = description.medium;
    if (description.density.empty()) return medium;
    const DensityGrid grid = read_density_grid(description.density, files);
    medium.largest_density = *std::ranges::max_element(grid.densities);
    if (double{medium.extinction} * medium.largest_density * glm::distance(dvec3(medium.low), dvec3(medium.high)) > max_steps)
        throw UserError(description.density.string() +
                        ": at its largest density a ray would collide more than 3000 times in its box: lower the \"extinction\"");
    if (medium.largest_density == 0) medium.extinction = 0;
    if (medium.extinction > 0) {
        medium.grid_size = grid.size;
        medium.first_density = static_cast<uint32_t>(scene.densities.size());
        scene.densities.insert(scene.densities.end(), grid.densities.begin(), grid.densities.end());
        if (scene.densities.size() > max_density_cells) throw UserError("its grids have too many cells together");
    }
    return medium;
}

}  // namespace

void place_media(Scene& scene, const std::vector<Body>& bodies, const Medium& outside, const std::vector<Medium>& media) {
    scene.media = {outside};
    scene.media.insert(scene.media.end(), media.begin(), media.end());
    const auto medium_around = [&](const Body& body) { return body.outside ? *body.outside + 1 : 0; };
    for (size_t i = 0; i < bodies.size(); ++i)
        if (bodies[i].is_cavity && bodies[i].outside)
            scene.media[i + 1] = Medium(scene.media[medium_around(bodies[*bodies[i].outside])]);
    if (bodies.empty()) return;

    // The first boundary is none. Those of an instance follow each other in the order of its mesh's parts.
    const size_t triangle_count = scene.triangles.size();
    scene.boundaries = {{}};
    scene.boundary_places.assign(triangle_count + scene.instances.size(), 0);
    std::vector<uint32_t> part_counts(scene.instances.size());
    for (const Body& body : bodies) part_counts[body.instance] = std::max(part_counts[body.instance], body.part + 1);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        scene.boundary_places[triangle_count + i] = static_cast<uint32_t>(scene.boundaries.size() - 1);
        scene.boundaries.insert(scene.boundaries.end(), part_counts[i] > 0 ? part_counts[i] + 1 : 0, {});
    }
    for (uint32_t i = 0; i < bodies.size(); ++i) {
        const Body& body = bodies[i];
        for (const uint32_t triangle : body.triangles) scene.boundary_places[triangle] = body.part + 1;
        Boundary& boundary = scene.boundaries[scene.boundary_places[triangle_count + body.instance] + body.part + 1];
        boundary.kind = body.is_open ? BOUNDARY_OPEN : BOUNDARY_GLASS;
        boundary.body = boundary.behind = i + 1;
        boundary.before = medium_around(body);
        if (body.volume < 0) std::swap(boundary.behind, boundary.before);
        boundary.first_overlap = static_cast<uint32_t>(scene.overlaps.size());
        for (const uint32_t other : body.overlaps) scene.overlaps.push_back(other + 1);
        boundary.end_overlaps = static_cast<uint32_t>(scene.overlaps.size());
    }
}

void add_media(const SceneDescription& description, std::vector<Body>& bodies, SourceFiles& files, Scene& scene) {
    const auto& placements = description.meshes;
    if (!description.fog && std::ranges::none_of(placements, [](const auto& placement) { return placement.medium.has_value(); }))
        return;
    const Medium outside = make_medium(description.fog.value_or(MediumDescription{}), files, scene);
    std::vector<Medium> of_instances;
    for (uint32_t i = 0; i < placements.size(); ++i) {
        if (placements[i].medium) check_surface(placements[i], scene, scene.mesh_of(i));
        of_instances.push_back(make_medium(placements[i].medium.value_or(MediumDescription{}), files, scene));
    }
    nest_bodies(scene, bodies);
    std::vector<Medium> media;
    for (const Body& body : bodies) {
        media.push_back(of_instances[body.instance]);
        const Medium& medium = media.back();
        if (medium.grid_size.x > 0 && !overlap(body.bounds, {medium.low, medium.high}))
            scene.warnings.push_back(scene.mesh_of(body.instance).file +
                                     ": the \"box\" of its medium lies beside it, so that nothing of the medium shows");
    }
    place_media(scene, bodies, outside, media);
    for (std::string& warning : body_warnings(scene, bodies)) scene.warnings.push_back(std::move(warning));
}

void leave_out_open_boundaries(Scene& scene) {
    for (size_t i = scene.instances.size(); i-- > 0;) {
        if (!scene.mesh_of(static_cast<uint32_t>(i)).is_open) continue;
        scene.instances.erase(scene.instances.begin() + static_cast<std::ptrdiff_t>(i));
        scene.instance_meshes.erase(scene.instance_meshes.begin() + static_cast<std::ptrdiff_t>(i));
    }
    scene.boundaries.clear();
}

}  // namespace lab
