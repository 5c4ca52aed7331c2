#include "tracing/scene_arrays.h"

#include <algorithm>
#include <numeric>

namespace lab {

std::string to_string(Strategy strategy) {
    return strategy == Strategy::both ? "both" : strategy == Strategy::light ? "light" : "bounces";
}

SceneArrays::SceneArrays(const Scene& scene, Strategy strategy, const Capabilities& handles) {
    const SceneFeatures features = features_of(scene);
    defines_ = features.defines();
    add("positions", BINDING_POSITIONS, scene.positions);
    add("triangles", BINDING_TRIANGLES, scene.triangles);
    add("materials of triangles", BINDING_TRIANGLE_MATERIALS, scene.triangle_materials);
    add_lights(scene, features, strategy, handles);
    add("materials", BINDING_MATERIALS, lights_.materials);
    if (features.microfacets && handles.microfacets) {
        add("microfacets", BINDING_MICROFACETS, scene.microfacets);
        defines_.emplace_back("FEATURE_MICROFACETS");
        if (scene.multiple_scattering) defines_.emplace_back("FEATURE_MULTIPLE_SCATTERING");
    }
    if (features.media && handles.media) {
        add("media", BINDING_MEDIA, scene.media);
        defines_.emplace_back("FEATURE_MEDIA");
        if (!scene.densities.empty()) {
            add("densities of media", BINDING_DENSITIES, scene.densities);
            defines_.emplace_back("FEATURE_DENSITIES");
        }
        if (!scene.boundaries.empty()) {
            add("boundaries of media", BINDING_BOUNDARIES, scene.boundaries);
            add("places of these boundaries", BINDING_BOUNDARY_PLACES, scene.boundary_places);
            defines_.emplace_back("FEATURE_BOUNDARIES");
        }
        if (!scene.overlaps.empty()) {
            add("bodies that overlap", BINDING_OVERLAPS, scene.overlaps);
            defines_.emplace_back("FEATURE_OVERLAPS");
        }
        if (std::ranges::any_of(scene.boundaries, [](const Boundary& boundary) { return boundary.kind == BOUNDARY_OPEN; }))
            defines_.emplace_back("FEATURE_OPEN_BOUNDARIES");
    }
    if (features.vertex_normals) add("vertex normals", BINDING_NORMALS, scene.normals);
    if (features.textures) {
        add("texture coordinates", BINDING_TEXTURE_COORDINATES, scene.texture_coordinates);
        for (const Texture& texture : scene.textures) texture_sizes_.emplace_back(texture.width, texture.height);
        add("sizes of textures", BINDING_TEXTURE_SIZES, texture_sizes_);
        defines_.push_back("TEXTURE_COUNT " + std::to_string(scene.textures.size()));
    }
    if (features.transforms) add("instances", BINDING_INSTANCES, scene.instances);
    if (features.double_sided) {
        other_sides_.resize(scene.triangles.size());
        std::iota(other_sides_.begin(), other_sides_.end(), 0u);
        for (const auto& sides : scene.double_sided) {
            other_sides_[sides.x] = sides.y;
            other_sides_[sides.y] = sides.x;
        }
        add("other sides of triangles", BINDING_OTHER_SIDES, other_sides_);
    }
    add_images(scene, features);
}

void SceneArrays::add_lights(const Scene& scene, const SceneFeatures& features, Strategy strategy, const Capabilities& handles) {
    const bool samples_probe = features.light_probe && handles.light_probe_sampling && strategy != Strategy::bounces;
    const bool samples_triangles = features.area_lights && strategy != Strategy::bounces;
    const float probe_probability = !samples_probe ? 0 : !samples_triangles ? 1 : LIGHT_PROBE_PROBABILITY;
    lights_.materials = scene.materials;
    if (samples_triangles) {
        lights_ = build_light_table(scene, 1 - probe_probability);
        add("light triangles", BINDING_LIGHT_TRIANGLES, lights_.triangles);
        defines_.emplace_back("FEATURE_LIGHT_TRIANGLES");
    }
    // Two triangles are one lamp, or leave little to choose: the table alone costs less.
    if (samples_triangles && handles.light_tree && lights_.triangles.size() > 2) {
        light_tree_ = build_light_tree(scene, lights_);
        add("nodes of the light tree", BINDING_LIGHT_NODES, light_tree_.nodes);
        add("leaves of the light tree", BINDING_LIGHT_LEAVES, light_tree_.leaves);
        add("places of these leaves", BINDING_LIGHT_PLACES, light_tree_.places);
        defines_.emplace_back("FEATURE_LIGHT_TREE");
    }
    if (samples_probe) {
        probe_cells_ = build_probe_table(*scene.light_probe, probe_probability);
        add("cells of the light probe", BINDING_PROBE_CELLS, probe_cells_);
        defines_.emplace_back("FEATURE_LIGHT_PROBE_CELLS");
    }
}

void SceneArrays::add_images(const Scene& scene, const SceneFeatures& features) {
    if (features.textures)
        for (const Texture& texture : scene.textures)
            images_.push_back(
                {"texture", BINDING_TEXTURES, std::as_bytes(std::span(texture.pixels)), texture.width, texture.height});
    if (!features.light_probe) return;
    // Four channels, since few devices support images of three floats; 32 bits, since the sun exceeds the range of 16.
    const Image& probe = *scene.light_probe;
    probe_texels_.reserve(probe.pixels.size() / 3 * 4);
    for (size_t i = 0; i < probe.pixels.size(); i += 3)
        probe_texels_.insert(probe_texels_.end(), {probe.pixels[i], probe.pixels[i + 1], probe.pixels[i + 2], 1.0f});
    images_.push_back({"light probe", BINDING_LIGHT_PROBE, std::as_bytes(std::span(probe_texels_)), probe.width, probe.height});
}

}  // namespace lab
