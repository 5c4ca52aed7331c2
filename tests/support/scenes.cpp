#include "support/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "scene/media.h"
#include "scene/microfacets.h"

namespace lab {
namespace {

// Makes all triangles one mesh, with one untransformed instance.
void finish(Scene& scene) {
    scene.file = "test scene";
    scene.triangle_materials.resize(scene.triangles.size(), 0);
    const auto dielectric_count =
        std::count_if(scene.triangle_materials.begin(), scene.triangle_materials.end(),
                      [&](uint32_t material) { return scene.materials[material].refractive_index > 0; });
    scene.meshes = {{"test mesh", 0, static_cast<uint32_t>(scene.triangles.size()), static_cast<uint32_t>(dielectric_count)}};
    set_transform(scene, mat4x3(1));
}

}  // namespace

Material diffuse_material(const vec3& albedo, const vec3& emission) {
    Material material{};
    material.diffuse_albedo = albedo;
    material.albedo_texture = -1;
    material.emission = emission;
    return material;
}

Medium homogeneous_medium(float extinction, const vec3& albedo, float anisotropy) {
    Medium medium{};
    medium.extinction = extinction;
    medium.albedo = albedo;
    medium.anisotropy = anisotropy;
    return medium;
}

void fill(Scene& scene, const Medium& medium, bool is_glass, uint32_t instance) {
    Mesh& mesh = scene.meshes[scene.instance_meshes[instance]];
    mesh.is_open = !is_glass;
    if (is_glass) mesh.dielectric_count = mesh.triangle_count;
    std::vector<Body> bodies = find_bodies(scene);
    nest_bodies(scene, bodies);
    std::vector<Medium> media;
    for (const Body& body : bodies) media.push_back(body.instance == instance ? medium : Medium{});
    place_media(scene, bodies, Medium{}, media);
}

Scene make_scene(const std::vector<Material>& materials, const std::vector<Quad>& quads) {
    Scene scene;
    scene.materials = materials;
    for (const Quad& quad : quads) {
        const auto first = static_cast<uint32_t>(scene.positions.size());
        scene.positions.insert(scene.positions.end(), {quad.corner, quad.corner + quad.edge_u,
                                                       quad.corner + quad.edge_u + quad.edge_v, quad.corner + quad.edge_v});
        scene.triangles.emplace_back(first, first + 1, first + 2);
        scene.triangles.emplace_back(first, first + 2, first + 3);
        scene.triangle_materials.insert(scene.triangle_materials.end(), 2, quad.material);
    }
    finish(scene);
    return scene;
}

std::vector<Quad> box_sides(const vec3& low, const vec3& high, uint32_t material, Facing facing) {
    std::vector<Quad> sides;
    for (int axis = 0; axis < 3; ++axis) {
        vec3 u(0), v(0), far_corner = low;
        u[(axis + 1) % 3] = high[(axis + 1) % 3] - low[(axis + 1) % 3];
        v[(axis + 2) % 3] = high[(axis + 2) % 3] - low[(axis + 2) % 3];
        far_corner[axis] = high[axis];
        if (facing == Facing::outwards) std::swap(u, v);
        sides.push_back({low, u, v, material});
        sides.push_back({far_corner, v, u, material});
    }
    return sides;
}

Scene closed_box(const Material& material) {
    Scene scene = make_scene({material}, box_sides(vec3(-1), vec3(1), 0, Facing::inwards));
    scene.camera = {.position = {0.3f, -0.2f, 0.5f}, .target = {-0.4f, 0.1f, -1}, .up = {0, 1, 0}, .vertical_fov = 70};
    return scene;
}

Scene random_lamps(int count, double decades, float size, const std::vector<Quad>& others) {
    std::mt19937 numbers(14);
    std::uniform_real_distribution<float> uniform(-1, 1);
    std::vector<Material> materials{diffuse_material(vec3(0.5f))};
    for (int i = 0; i < 13; ++i)
        materials.push_back(diffuse_material(vec3(0.5f), vec3(static_cast<float>(std::pow(10, -decades * i / 12)))));
    const auto random = [&] { return vec3(uniform(numbers), uniform(numbers), uniform(numbers)); };
    std::vector<Quad> quads = others;
    for (int i = 0; i < count; ++i)
        quads.push_back({random(), size * random(), size * random(), static_cast<uint32_t>(1 + i % 13)});
    return make_scene(materials, quads);
}

void make_metal(Scene& scene, float roughness) {
    Microfacets metal{};
    metal.roughness = roughness * roughness;
    metal.metalness = 1;
    metal.coat_index = 1.5f;
    integrate_albedo(metal);
    scene.microfacets.assign(scene.materials.size(), metal);
}

Scene make_sphere(const Material& material, Facing facing) {
    Scene scene;
    scene.materials = {material};
    // The corners of an icosahedron are those of three golden rectangles.
    const float golden = (1 + std::sqrt(5.0f)) / 2;
    std::vector<vec3> corners;
    for (int axis = 0; axis < 3; ++axis)
        for (const float a : {-1.0f, 1.0f})
            for (const float b : {-golden, golden}) {
                vec3 corner(0);
                corner[(axis + 1) % 3] = a;
                corner[(axis + 2) % 3] = b;
                corners.push_back(corner);
            }
    const auto add_triangle = [&](vec3 a, vec3 b, vec3 c) {
        const bool is_outwards = glm::dot(glm::cross(b - a, c - a), a) > 0;
        if (is_outwards != (facing == Facing::outwards)) std::swap(b, c);
        const auto first = static_cast<uint32_t>(scene.positions.size());
        for (const vec3& corner : {a, b, c}) scene.positions.push_back(glm::normalize(corner));
        scene.triangles.emplace_back(first, first + 1, first + 2);
    };
    // Three corners that are one edge length, 2, apart form a face.
    const auto are_neighbours = [&](size_t i, size_t j) { return glm::distance(corners[i], corners[j]) < 2.1f; };
    for (size_t i = 0; i < corners.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            for (size_t k = 0; k < j; ++k) {
                if (!are_neighbours(i, j) || !are_neighbours(j, k) || !are_neighbours(i, k)) continue;
                const vec3 a = corners[i], b = corners[j], c = corners[k];
                const vec3 ab = a + b, bc = b + c, ca = c + a;  // on the sphere once normalised
                const float length = glm::length(a);
                const auto lift = [&](const vec3& v) { return length * glm::normalize(v); };
                add_triangle(a, lift(ab), lift(ca));
                add_triangle(b, lift(bc), lift(ab));
                add_triangle(c, lift(ca), lift(bc));
                add_triangle(lift(ab), lift(bc), lift(ca));
            }
    finish(scene);
    scene.camera = facing == Facing::inwards ? CameraPose{{0.1f, 0.2f, 0.3f}, {1, 0.5f, -1}, {0, 1, 0}, 60}
                                             : CameraPose{{3, 1, 2}, {0, 0, 0}, {0, 1, 0}, 20};
    return scene;
}

TriangleMesh bumpy_sphere(uint32_t rings) {
    TriangleMesh mesh;
    for (uint32_t ring = 0; ring <= rings; ++ring)
        for (uint32_t segment = 0; segment < rings; ++segment) {
            const double theta = std::numbers::pi * ring / rings;
            const double phi = 2 * std::numbers::pi * segment / rings;
            const double radius = 1 + 0.1 * std::sin(7 * theta) * std::sin(5 * phi);
            // All vertices at a pole coincide exactly, or there would be a hole of 10^-16 between them.
            const double sine = ring % rings == 0 ? 0 : std::sin(theta);
            mesh.positions.emplace_back(radius * sine * std::cos(phi), radius * std::cos(theta), radius * sine * std::sin(phi));
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
    scene.materials = {diffuse_material({0.3f, 0.5f, 0.7f})};
    scene.positions = mesh.positions;
    scene.triangles = mesh.triangles;
    if (!mesh.triangles.empty()) finish(scene);
    scene.instances.clear();
    scene.instance_meshes.clear();
    return scene;
}

void place(Scene& scene, const mat4x3& object_to_world) {
    // In 64 bits, as the loader does it: a determinant is a volume.
    scene.instances.push_back({object_to_world, mat3(glm::inverse(glm::transpose(glm::dmat3(object_to_world))))});
    scene.instance_meshes.push_back(0);
}

void set_transform(Scene& scene, const mat4x3& object_to_world) {
    scene.instances.clear();
    scene.instance_meshes.clear();
    place(scene, object_to_world);
}

std::vector<std::filesystem::path> sorted_entries(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> entries;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) entries.push_back(entry.path());
    std::sort(entries.begin(), entries.end());
    return entries;
}

}  // namespace lab
