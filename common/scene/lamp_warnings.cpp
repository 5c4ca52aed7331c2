#include "scene/lamp_warnings.h"

namespace lab {
namespace {

// Whether the camera or a part of the scene lies before the triangle's front, judged by the scene's bounding box.
bool faces_anything(const Scene& scene, uint32_t instance, uint32_t triangle, const Bounds& bounds) {
    const glm::dvec3 origin = world_corner(scene, instance, triangle, 0);
    glm::dvec3 normal =
        glm::cross(world_corner(scene, instance, triangle, 1) - origin, world_corner(scene, instance, triangle, 2) - origin);
    normal /= glm::length(normal);
    if (glm::determinant(glm::dmat3(mat3(scene.instances[instance].object_to_world))) < 0) normal = -normal;
    if (glm::dot(normal, glm::dvec3(scene.camera.position) - origin) > 0) return true;
    const glm::dvec3 low(bounds.low), high(bounds.high);
    // More than the gap between a lamp and its ceiling.
    return glm::dot(normal, glm::mix(low, high, glm::greaterThan(normal, glm::dvec3(0))) - origin) >
           0.01 * glm::distance(low, high);
}

}  // namespace

std::vector<std::string> lamp_warnings(const Scene& scene) {
    const Bounds bounds = world_bounds(scene);
    bool has_lamps = false;
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance)
        for (const uint32_t triangle : scene.mesh_of(instance).triangles()) {
            if (scene.material_of(triangle).emission == vec3(0)) continue;
            if (faces_anything(scene, instance, triangle, bounds)) return {};
            has_lamps = true;
        }
    if (!has_lamps) return {};
    return {
        scene.file.string() +
        ": its lamps face away from the camera and from everything else: a lamp shines from the side from which its corners go "
        "counter-clockwise, so turn their order around"};
}

}  // namespace lab
