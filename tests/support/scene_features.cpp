#include "support/scene_features.h"

#include "scene/microfacets.h"
#include "support/scenes.h"

namespace lab {
namespace {

void add_vertex_normals(Scene& scene) {
    scene.normals.assign(scene.positions.size(), vec3(0));
    for (const uvec3& corners : scene.triangles) {
        const vec3 a = scene.positions[corners.x], b = scene.positions[corners.y], c = scene.positions[corners.z];
        for (int i = 0; i < 3; ++i) scene.normals[corners[i]] += glm::cross(b - a, c - a);
    }
    for (vec3& normal : scene.normals) normal = normal == vec3(0) ? vec3(0, 1, 0) : glm::normalize(normal);
}

// All materials get the same white texture.
void add_texture(Scene& scene) {
    constexpr uint32_t size = 64;
    scene.textures = {{size, size, std::vector<uint8_t>(4 * size * size, 255)}};
    for (const vec3& position : scene.positions) scene.texture_coordinates.emplace_back(position.x, position.y + position.z);
    for (Material& material : scene.materials) material.albedo_texture = 0;
}

void add_sky(Scene& scene) { scene.background = vec3(0.5f); }

void add_light_probe(Scene& scene) {
    constexpr uint32_t width = 128, height = 64;
    scene.background = vec3(1);
    scene.light_probe = Image{width, height, std::vector<float>(3 * width * height, 0.5f)};
}

void add_area_light(Scene& scene) { scene.materials.back().emission = vec3(1); }

void add_phong_lobe(Scene& scene) {
    for (Material& material : scene.materials) {
        material.specular_albedo = vec3(0.1f);
        material.specular_exponent = 20;
    }
}

void add_dielectric(Scene& scene) {
    Material glass = scene.materials.front();
    glass.refractive_index = 1.5f;
    scene.triangle_materials.back() = static_cast<uint32_t>(scene.materials.size());
    scene.materials.push_back(glass);
    scene.meshes.front().dielectric_count = 1;
}

void add_absorption(Scene& scene) {
    add_dielectric(scene);
    scene.materials.back().absorption = vec3(1);
}

void add_microfacets(Scene& scene) {
    Microfacets plastic{};
    plastic.roughness = 0.25f;
    plastic.coat_index = 1.5f;
    integrate_albedo(plastic);
    scene.microfacets.assign(scene.materials.size(), plastic);
}

void add_lens(Scene& scene) { scene.camera.aperture_diameter = 0.1f; }

void add_medium(Scene& scene) { scene.media = {homogeneous_medium(0.1f, vec3(0.5f))}; }

void add_densities(Scene& scene) {
    add_medium(scene);
    scene.densities = {1};
    scene.media.front().grid_size = uvec3(1);
    scene.media.front().largest_density = 1;
    scene.media.front().low = vec3(-1), scene.media.front().high = vec3(1);
}

void add_transform(Scene& scene) { scene.instances.front().object_to_world[3] += vec3(0, 1e-3f, 0); }

}  // namespace

const std::vector<SceneFeature>& all_scene_features() {
    static const std::vector<SceneFeature> features{{"vertex normals", add_vertex_normals},
                                                    {"textures", add_texture},
                                                    {"sky", add_sky},
                                                    {"light probe", add_light_probe},
                                                    {"area lights", add_area_light},
                                                    {"Phong lobe", add_phong_lobe},
                                                    {"dielectrics", add_dielectric},
                                                    {"absorption", add_absorption},
                                                    {"transforms", add_transform},
                                                    {"microfacets", add_microfacets},
                                                    {"lens", add_lens},
                                                    {"media", add_medium},
                                                    {"densities", add_densities}};
    return features;
}

}  // namespace lab
