#include "measure/box_scene.h"

#include <array>
#include <numbers>

namespace lab {
namespace {

#include "ceiling_light.h"

enum : uint32_t { white, red, green, light };

void add_quad(Scene& scene, std::array<vec3, 4> corners, uint32_t material) {
    const auto first = static_cast<uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), corners.begin(), corners.end());
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.triangles.push_back({first, first + 2, first + 3});
    scene.triangle_materials.insert(scene.triangle_materials.end(), 2, material);
}

void add_bumpy_sphere(Scene& scene, uint32_t segments, uint32_t rings) {
    constexpr vec3 centre(0, -0.35f, 0);
    const auto first = static_cast<uint32_t>(scene.positions.size());
    for (uint32_t ring = 0; ring <= rings; ++ring)
        for (uint32_t segment = 0; segment < segments; ++segment) {
            const float theta = std::numbers::pi_v<float> * static_cast<float>(ring) / static_cast<float>(rings);
            const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(segment) / static_cast<float>(segments);
            const float radius = 0.6f + 0.06f * std::sin(7 * theta) * std::sin(9 * phi) * std::sin(theta);
            scene.positions.push_back(
                centre + radius * vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)));
        }
    const auto vertex = [&](uint32_t ring, uint32_t segment) { return first + ring * segments + segment % segments; };
    const size_t box_triangles = scene.triangles.size();
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t segment = 0; segment < segments; ++segment) {
            const uint32_t a = vertex(ring, segment), b = vertex(ring, segment + 1);
            const uint32_t c = vertex(ring + 1, segment + 1), d = vertex(ring + 1, segment);
            if (ring > 0) scene.triangles.push_back({a, b, c});
            if (ring + 1 < rings) scene.triangles.push_back({a, c, d});
        }
    scene.triangle_materials.insert(scene.triangle_materials.end(), scene.triangles.size() - box_triangles, white);
}

}  // namespace

Scene make_box_scene(uint32_t segments, uint32_t rings, uint32_t light_cells) {
    Scene scene;
    scene.file = "benchmark";
    Material white_paint{};
    white_paint.diffuse_albedo = vec3(0.75f);
    white_paint.albedo_texture = -1;
    scene.materials.resize(4, white_paint);
    scene.materials[red].diffuse_albedo = {0.7f, 0.1f, 0.1f};
    scene.materials[green].diffuse_albedo = {0.15f, 0.5f, 0.15f};
    scene.materials[light].emission = LIGHT_RADIANCE;
    add_quad(scene, {vec3(-1, -1, 1), {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}}, white);
    add_quad(scene, {vec3(-1, 1, -1), {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, white);
    add_quad(scene, {vec3(-1, -1, -1), {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}, white);
    add_quad(scene, {vec3(-1, -1, 1), {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}}, red);
    add_quad(scene, {vec3(1, -1, -1), {1, -1, 1}, {1, 1, 1}, {1, 1, -1}}, green);
    const auto point = [&](uint32_t i, uint32_t j) {
        const vec2 position = vec2(i, j) / static_cast<float>(light_cells);
        return LIGHT_CORNER + position.x * LIGHT_EDGE_1 + position.y * LIGHT_EDGE_2;
    };
    for (uint32_t i = 0; i < light_cells; ++i)
        for (uint32_t j = 0; j < light_cells; ++j)
            add_quad(scene, {point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)}, light);
    add_bumpy_sphere(scene, segments, rings);
    scene.meshes.push_back({"benchmark", 0, static_cast<uint32_t>(scene.triangles.size())});
    scene.instances.push_back({.object_to_world = mat4x3(1), .normal_to_world = mat3(1)});
    scene.instance_meshes.push_back(0);
    scene.camera = {.position = {0, 0, 3.6f}, .target = {0, 0, 0}, .vertical_fov = 42};
    return scene;
}

}  // namespace lab
