#include "scene/light_table.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "error.h"
#include "scene/alias_table.h"
#include "scene/coincident_lights.h"

namespace lab {

double get_luminance(const vec3& colour) { return 0.2126 * colour.r + 0.7152 * colour.g + 0.0722 * colour.b; }

namespace {

constexpr uint64_t max_light_triangles = 1u << 24;

double get_world_area(const Scene& scene, const LightTriangle& light) {
    const glm::dmat3 linear{mat3(scene.instances[light.instance].object_to_world)};
    const glm::dvec3 origin(scene.corner(light.triangle, 0));
    const auto side = [&](int i) { return linear * (glm::dvec3(scene.corner(light.triangle, i)) - origin); };
    return 0.5 * glm::length(glm::cross(side(1), side(2)));
}

// Rays find one of several instances' emissive triangles in the same place: the table counts the first, too,
// and keeps the order.
void keep_one_in_each_place(const Scene& scene, std::vector<LightTriangle>& lights) {
    std::vector<std::pair<Place, size_t>> places;
    places.reserve(lights.size());
    for (const LightTriangle& light : lights)
        places.emplace_back(get_place(scene, scene.instances[light.instance], light.triangle), places.size());
    std::sort(places.begin(), places.end());
    std::vector<bool> is_first(lights.size(), true);
    for (size_t i = 1; i < places.size(); ++i)
        is_first[places[i].second] = places[i].first != places[i - 1].first;
    size_t kept = 0;
    for (size_t i = 0; i < lights.size(); ++i)
        if (is_first[i]) lights[kept++] = lights[i];
    lights.resize(kept);
}

}  // namespace

LightTable build_light_table(const Scene& scene, double probability) {
    const auto luminance_of = [&](uint32_t triangle) {
        return get_luminance(scene.material_of(triangle).emission);
    };
    std::vector<std::vector<uint32_t>> emissive_triangles;  // of each mesh, which may have many instances
    for (const Mesh& mesh : scene.meshes) {
        auto& triangles = emissive_triangles.emplace_back();
        std::ranges::copy_if(mesh.triangles(), std::back_inserter(triangles),
                             [&](uint32_t triangle) { return luminance_of(triangle) > 0; });
    }
    uint64_t count = 0;
    for (const uint32_t mesh : scene.instance_meshes) count += emissive_triangles[mesh].size();
    if (count > max_light_triangles)
        throw UserError(
            scene.file.string() + ": its instances have " + std::to_string(count) +
            " emissive triangles together, more than 2^24: remove instances or use simpler lights");

    LightTable table{.triangles = {}, .materials = scene.materials};
    std::vector<LightTriangle>& lights = table.triangles;
    lights.reserve(count);
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance)
        for (const uint32_t triangle : emissive_triangles[scene.instance_meshes[instance]])
            lights.push_back({instance, triangle, 0, 0, 0});
    keep_one_in_each_place(scene, lights);
    if (lights.empty()) return table;
    std::vector<double> areas, weights;
    for (const LightTriangle& light : lights) {
        areas.push_back(get_world_area(scene, light));
        weights.push_back(areas.back() * luminance_of(light.triangle));
    }
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (Material& material : table.materials)
        material.light_density = static_cast<float>(probability * get_luminance(material.emission) / sum);
    const AliasTable alias_table = build_alias_table(weights);
    for (size_t i = 0; i < lights.size(); ++i) {
        lights[i].threshold = alias_table.entries[i].threshold;
        lights[i].alias = alias_table.entries[i].alias;
        lights[i].inverse_density =
            static_cast<float>(areas[i] / (probability * alias_table.probabilities[i]));
    }
    return table;
}

}  // namespace lab
