#include "support/meshes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lab {

TriangleMesh bumpy_sphere(uint32_t rings) {
    TriangleMesh mesh;
    for (uint32_t ring = 0; ring <= rings; ++ring)
        for (uint32_t segment = 0; segment < rings; ++segment) {
            const double theta = std::numbers::pi * ring / rings;
            const double phi = 2 * std::numbers::pi * segment / rings;
            const double radius = 1 + 0.1 * std::sin(7 * theta) * std::sin(5 * phi);
            // All vertices of a pole in exactly the same place, else there is a hole of 10^-16 between them.
            const double sine = ring % rings == 0 ? 0 : std::sin(theta);
            mesh.positions.emplace_back(radius * sine * std::cos(phi), radius * std::cos(theta),
                                        radius * sine * std::sin(phi));
        }
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t segment = 0; segment < rings; ++segment) {
            const uint32_t next = (segment + 1) % rings;
            const uint32_t a = ring * rings + segment, b = ring * rings + next;
            if (ring > 0) mesh.triangles.emplace_back(a, b, a + rings);
            if (ring + 1 < rings) mesh.triangles.emplace_back(b, b + rings, a + rings);
        }
    return mesh;
}

Scene lit_scene(const TriangleMesh& mesh) {
    Scene scene;
    scene.background = vec3(1);
    scene.camera = {.position = {0, 1, 6}, .target = {0, 0, 0}};
    Material grey{};
    grey.diffuse_albedo = vec3(0.3f, 0.5f, 0.7f);
    grey.albedo_texture = -1;
    scene.materials = {grey};
    if (mesh.triangles.empty()) return scene;
    scene.positions = mesh.positions;
    scene.triangles = mesh.triangles;
    scene.triangle_materials.assign(mesh.triangles.size(), 0);
    scene.meshes = {{"mesh", 0, static_cast<uint32_t>(mesh.triangles.size())}};
    return scene;
}

void place(Scene& scene, const mat4x3& object_to_world) {
    const mat3 linear(object_to_world);
    scene.instances.push_back({object_to_world, glm::inverse(glm::transpose(linear))});
    scene.instance_meshes.push_back(0);
}

std::vector<std::filesystem::path> sorted_entries(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> entries;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) entries.push_back(entry.path());
    std::sort(entries.begin(), entries.end());
    return entries;
}

}  // namespace lab
