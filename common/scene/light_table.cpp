#include "scene/light_table.h"

#include "scene/alias_table.h"

namespace lab {
namespace {

// Of linear sRGB (ITU-R BT.709).
double get_luminance(const vec3& colour) { return 0.2126 * colour.r + 0.7152 * colour.g + 0.0722 * colour.b; }

double get_world_area(const Scene& scene, uint32_t instance, const uvec3& corners) {
    const glm::dmat3 linear{mat3(scene.instances[instance].object_to_world)};
    const glm::dvec3 origin(scene.positions[corners.x]);
    return 0.5 * glm::length(glm::cross(linear * (glm::dvec3(scene.positions[corners.y]) - origin),
                                        linear * (glm::dvec3(scene.positions[corners.z]) - origin)));
}

}  // namespace

std::vector<LightTriangle> build_light_table(const Scene& scene) {
    struct Place {
        uint32_t instance, triangle;
    };
    std::vector<Place> places;
    std::vector<double> areas, weights;
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance) {
        const Mesh& mesh = scene.meshes[scene.instance_meshes[instance]];
        for (uint32_t i = mesh.first_triangle; i < mesh.first_triangle + mesh.triangle_count; ++i) {
            const double luminance = get_luminance(scene.materials[scene.triangle_materials[i]].emission);
            if (luminance == 0) continue;
            places.push_back({instance, i});
            areas.push_back(get_world_area(scene, instance, scene.triangles[i]));
            weights.push_back(areas.back() * luminance);
        }
    }
    if (places.empty()) return {};
    const AliasTable table = build_alias_table(weights);
    std::vector<LightTriangle> lights(places.size());
    for (size_t i = 0; i < lights.size(); ++i)
        lights[i] = {.instance = places[i].instance,
                     .triangle = places[i].triangle,
                     .threshold = table.entries[i].threshold,
                     .alias = table.entries[i].alias,
                     .inverse_density = static_cast<float>(areas[i] / table.probabilities[i])};
    return lights;
}

}  // namespace lab
