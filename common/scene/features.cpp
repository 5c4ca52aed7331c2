#include "scene/features.h"

#include <algorithm>
#include <utility>

#include "scene/material_keywords.h"

namespace lab {

SceneFeatures features_of(const Scene& scene) {
    const auto any_material = [&](auto property) {
        return std::any_of(scene.materials.begin(), scene.materials.end(), property);
    };
    const auto is_moved = [](const Instance& instance) { return instance.object_to_world != mat4x3(1); };
    SceneFeatures features;
    features.vertex_normals = !scene.normals.empty();
    features.textures = !scene.textures.empty();
    features.light_probe = scene.light_probe.has_value();
    features.sky = !features.light_probe && scene.background != vec3(0);
    features.area_lights = any_material([](const Material& material) { return material.emission != vec3(0); });
    for (const MaterialKeyword& keyword : material_keywords) {
        const MaterialMember& member = keyword.member;
        const auto has_lobe = [&](const Material& material) { return material.*member.colour != vec3(0); };
        if (member.feature && any_material(has_lobe)) features.lobes.emplace_back(member.feature);
    }
    features.dielectrics = any_material([](const Material& material) { return material.refractive_index > 0; });
    features.absorption = any_material([](const Material& material) { return material.absorption != vec3(0); });
    features.double_sided = !scene.double_sided.empty();
    features.transforms = std::any_of(scene.instances.begin(), scene.instances.end(), is_moved);
    features.microfacets = !scene.microfacets.empty();
    features.media = !scene.media.empty();
    features.lens = scene.camera.aperture_diameter > 0;
    return features;
}

std::vector<std::string> SceneFeatures::defines() const {
    const std::pair<bool, const char*> names[] = {
        {vertex_normals, "FEATURE_VERTEX_NORMALS"}, {textures, "FEATURE_TEXTURES"},       {sky, "FEATURE_SKY"},
        {light_probe, "FEATURE_LIGHT_PROBE"},       {dielectrics, "FEATURE_DIELECTRICS"}, {absorption, "FEATURE_ABSORPTION"},
        {double_sided, "FEATURE_DOUBLE_SIDED"},     {transforms, "FEATURE_TRANSFORMS"},   {lens, "FEATURE_LENS"},
    };
    std::vector<std::string> present = lobes;
    for (const auto& [is_present, name] : names)
        if (is_present) present.emplace_back(name);
    return present;
}

}  // namespace lab
