// Chapter 15: light paths and camera paths share the light. What light paths find equals a closed form, and what camera paths
// find of the same light when they look for all of it.
#include <cmath>
#include <numbers>

#include "scene/microfacets.h"
#include "support/agreement.h"
#include "support/dielectric_scenes.h"
#include "support/expect_statistics.h"

namespace lab {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr uint32_t light_path_batches = 32;

RenderSettings light_path_settings(uint32_t samples, uint32_t seed) {
    return {.width = 48,
            .height = 48,
            .samples = samples,
            .max_path_length = 1000,
            .seed = seed,
            .roulette_start = 3,
            .survival_weight = 0.5f,
            .estimator = chapter_estimator(chapter_named("light_paths")),
            .backend = fastest_backend()};
}

// A square lamp of radiance 1 above a pane of glass above a floor, seen from between the two.
constexpr double lamp_side = 0.1, lamp_height = 1, pane_height = 0.6, pane_thickness = 0.1, floor_albedo = 0.6;

Scene lamp_above_pane(float refractive_index) {
    const auto side = static_cast<float>(lamp_side), height = static_cast<float>(lamp_height);
    std::vector<Quad> quads{{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0},
                            {{-0.5f * side, height, -0.5f * side}, {side, 0, 0}, {0, 0, side}, 1}};
    if (refractive_index > 0) {
        const auto low = static_cast<float>(pane_height), high = static_cast<float>(pane_height + pane_thickness);
        for (const Quad& quad : box_sides({-20, low, -20}, {20, high, 20}, 2, Facing::outwards)) quads.push_back(quad);
    }
    Scene scene = make_scene({diffuse_material(vec3(static_cast<float>(floor_albedo))), diffuse_material(vec3(0), vec3(1)),
                              dielectric_material(refractive_index)},
                             quads);
    scene.camera = {.position = {0, 0.5f, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .vertical_fov = 90};
    return scene;
}

// How far a ray from the lamp at this angle gets until it meets the floor, and what the pane lets through.
double distance_on_floor(double sine, double index) {
    const double cosine = std::sqrt(1 - sine * sine), in_glass = sine / index;
    return (lamp_height - pane_thickness) * sine / cosine + pane_thickness * in_glass / std::sqrt(1 - in_glass * in_glass);
}

double transmittance(double sine, double index) {
    const double cosine = std::sqrt(1 - sine * sine), cosine_in_glass = std::sqrt(1 - sine * sine / (index * index));
    const double s = (cosine - index * cosine_in_glass) / (cosine + index * cosine_in_glass);
    const double p = (index * cosine - cosine_in_glass) / (index * cosine + cosine_in_glass);
    const double reflectance = 0.5 * (s * s + p * p);
    return (1 - reflectance) * (1 - reflectance);
}

// The irradiance of the floor at this distance from the foot of a point of the lamp, for each unit of the lamp's area:
// L cos θ T dΩ/dA with dΩ/dA = sin θ dθ / (r dr).
double irradiance_at(double distance, double index) {
    double low = 0, high = 1 - 1e-12;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (distance_on_floor(middle, index) < distance ? low : high) = middle;
    }
    const double sine = 0.5 * (low + high), step = 1e-5;
    // d(sin θ)/dr, and dθ = d(sin θ) / cos θ.
    const double slope = 2 * step / (distance_on_floor(sine + step, index) - distance_on_floor(sine - step, index));
    return transmittance(sine, index) * sine * slope / distance;
}

// The mean radiance of the floor over tiles of the picture, by midpoints of pixels and of parts of the lamp.
double expected_radiance(uvec2 corner, uvec2 size, uint32_t width, double index) {
    constexpr int parts = 4;
    double sum = 0;
    for (uint32_t y = corner.y; y < corner.y + size.y; ++y)
        for (uint32_t x = corner.x; x < corner.x + size.x; ++x)
            for (int i = 0; i < parts * parts; ++i) {
                // The camera's picture is 1 wide where it meets the floor.
                const dvec2 on_floor = (dvec2(x, y) + 0.5) / double(width) - 0.5;
                const dvec2 on_lamp = lamp_side * ((dvec2(i % parts, i / parts) + 0.5) / double(parts) - 0.5);
                sum += irradiance_at(glm::distance(on_floor, on_lamp), index);
            }
    const double irradiance = sum * lamp_side * lamp_side / (parts * parts) / (size.x * size.y);
    return floor_albedo / std::numbers::pi * irradiance;
}

TEST(LightPaths, ThroughAPaneFollowSnellAndFresnel_all) {
    RenderSettings settings = light_path_settings(64, 1);
    settings.only_path_length = 3;  // two boundaries and the floor
    const Batches batches = render_batches(lamp_above_pane(1.5f), settings, light_path_batches);
    expect_mean("picture", estimate_mean(batches.means(1)), expected_radiance({0, 0}, {48, 48}, 48, 1.5), 0.003, 4);
    for (const uint32_t corner : {0u, 8u, 16u})
        expect_mean("tile at " + std::to_string(corner), estimate_mean(batches.means(1, uvec2(corner), uvec2(16))),
                    expected_radiance(uvec2(corner), uvec2(16), 48, 1.5), 0.03, 4);
}

// A closed form for the scene without the pane is tested elsewhere.
TEST(LightPaths, ThroughGlassOfIndexOneLeaveThePictureAsItIs) {
    RenderSettings settings = light_path_settings(64, 2);
    settings.only_path_length = 3;
    const Batches through = render_batches(lamp_above_pane(1), settings, light_path_batches);
    settings.only_path_length = 1;
    expect_agreement("index 1", through, render_batches(lamp_above_pane(0), settings, light_path_batches), {0.0025, 0.09});
}

// The room with a ball of glass whose few facets have smooth normals.
Scene room_with_ball(const Material& glass) {
    constexpr uint32_t rings = 6, segments = 10;
    const vec3 centre(0.1f, -0.3f, 0);
    Scene scene = empty_room();
    const auto material = static_cast<uint32_t>(scene.materials.size());
    scene.materials.push_back(glass);
    scene.normals.assign(scene.positions.size(), vec3(0));  // geometric ones will do
    const auto first = static_cast<uint32_t>(scene.positions.size());
    for (uint32_t ring = 0; ring <= rings; ++ring)
        for (uint32_t segment = 0; segment < segments; ++segment) {
            const float theta = std::numbers::pi_v<float> * static_cast<float>(ring) / rings;
            const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(segment) / segments;
            const vec3 normal(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
            scene.positions.push_back(centre + 0.5f * normal);
            scene.normals.push_back(normal);
        }
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t segment = 0; segment < segments; ++segment) {
            const uint32_t next = (segment + 1) % segments, upper = first + ring * segments, lower = upper + segments;
            if (ring > 0) scene.triangles.emplace_back(upper + segment, lower + next, upper + next);
            if (ring + 1 < rings) scene.triangles.emplace_back(upper + segment, lower + segment, lower + next);
        }
    scene.meshes[0].dielectric_count = static_cast<uint32_t>(scene.triangles.size()) - scene.meshes[0].triangle_count;
    scene.meshes[0].triangle_count = static_cast<uint32_t>(scene.triangles.size());
    scene.triangle_materials.resize(scene.triangles.size(), material);
    return scene;
}

// A pool that contains the camera and its own floor.
Scene pool() {
    std::vector<Quad> quads = box_sides(vec3(-1), vec3(1), 0, Facing::inwards);
    quads.push_back({{-0.7f, 0.95f, -0.7f}, {1.4f, 0, 0}, {0, 0, 1.4f}, 1});
    quads.push_back({{-0.8f, -0.8f, -0.8f}, {0, 0, 1.6f}, {1.6f, 0, 0}, 0});
    for (const Quad& side : box_sides({-0.9f, -0.9f, -0.9f}, {0.9f, 0.3f, 0.9f}, 2, Facing::outwards)) quads.push_back(side);
    Scene scene = make_scene(
        {diffuse_material({0.7f, 0.5f, 0.3f}), diffuse_material(vec3(0.5f), {2, 3, 4}), dielectric_material(1.33f)}, quads);
    scene.camera = {.position = {0, 0, 0.7f}, .target = {0, -0.7f, -0.2f}, .up = {0, 1, 0}, .vertical_fov = 60};
    return scene;
}

// Rough glass and plastic beside smooth glass.
Scene room_with_microfacets() {
    Scene scene = room_with_ball(dielectric_material(1.5f));
    scene.microfacets.assign(scene.materials.size(), Microfacets{});
    for (Microfacets& of_material : scene.microfacets) of_material.coat_index = 1.5f;
    scene.microfacets[0].roughness = 0.2f;
    integrate_albedo(scene.microfacets[0]);
    return scene;
}

// A pane of smooth glass above one of rough glass: what the camera sees has passed both.
Scene panes() {
    std::vector<Quad> quads = box_sides(vec3(-1), vec3(1), 0, Facing::inwards);
    quads.push_back({{-0.7f, 0.95f, -0.7f}, {1.4f, 0, 0}, {0, 0, 1.4f}, 1});
    for (const Quad& side : box_sides({-0.9f, 0.5f, -0.9f}, {0.9f, 0.6f, 0.9f}, 2, Facing::outwards)) quads.push_back(side);
    for (const Quad& side : box_sides({-0.9f, 0.2f, -0.9f}, {0.9f, 0.4f, 0.9f}, 3, Facing::outwards)) quads.push_back(side);
    Scene scene = make_scene({diffuse_material(vec3(0.3f)), diffuse_material(vec3(0.5f), {2, 3, 4}), dielectric_material(1.5f),
                              dielectric_material(1.5f)},
                             quads);
    scene.microfacets.assign(scene.materials.size(), Microfacets{});
    for (Microfacets& of_material : scene.microfacets) of_material.coat_index = 1.5f;
    scene.microfacets[3].roughness = 0.3f;
    integrate_albedo(scene.microfacets[3]);
    scene.camera = {.position = {0, -0.7f, 0.5f}, .target = {0, 0.4f, 0}, .up = {0, 1, 0}, .vertical_fov = 60};
    return scene;
}

struct SharedLight {
    const char* name;
    Scene (*make)();
    AgreementLimits limits;
    uint32_t max_path_length = 1000;
    int only_path_length = -1;
};

const Material coloured_glass = dielectric_material(1.5f, {0.5f, 0.2f, 0.8f});

const SharedLight shared_lights[] = {
    {"box_all", [] { return room_with_box(coloured_glass); }, {0.006, 0.1}},
    {"ball_with_smooth_normals_all", [] { return room_with_ball(dielectric_material(1.5f)); }, {0.006, 0.1}},
    {"wide_camera_all",
     [] {
         Scene scene = room_with_ball(dielectric_material(1.5f));
         scene.camera.vertical_fov = 140;
         return scene;
     },
     {0.006, 0.1}},
    {"pool_all", pool, {0.012, 0.2}},
    {"lens_all",
     [] {
         Scene scene = room_with_ball(dielectric_material(1.5f));
         scene.camera.aperture_diameter = 0.3f;
         scene.camera.focus_distance = 1.2f;
         return scene;
     },
     {0.006, 0.1}},
    {"rough_glass_behind_smooth_glass", panes, {0.05, 0.75}},
    {"microfacets_all", room_with_microfacets, {0.006, 0.1}},
    {"probe_all",
     [] {
         Scene scene = glass_with_lamp(coloured_glass);
         scene.background = vec3(1);
         scene.light_probe = Image{8, 4, std::vector<float>(8 * 4 * 3, 0.2f)};
         return scene;
     },
     {0.01, 0.2}},
    {"many_lamps_all",
     [] {
         std::vector<Quad> quads = box_sides(vec3(-1.5f), vec3(1.5f), 0, Facing::inwards);
         Scene scene = random_lamps(60, 1, 0.4f, quads);
         return scene;
     },
     {0.006, 0.1}},
    {"one_length_all", [] { return room_with_box(coloured_glass); }, {0.02, 0.3}, 6, 5},
};

class SharedLightOf : public testing::TestWithParam<SharedLight> {};
INSTANTIATE_TEST_SUITE_P(, SharedLightOf, testing::ValuesIn(shared_lights),
                         [](const auto& of) { return std::string(of.param.name); });

TEST_P(SharedLightOf, LightAndCameraPathsIsThatOfCameraPaths) {
    const Scene scene = GetParam().make();
    RenderSettings settings = light_path_settings(32, 3);
    settings.max_path_length = GetParam().max_path_length;
    settings.only_path_length = GetParam().only_path_length;
    const Batches shared = render_batches(scene, settings, light_path_batches);
    settings.estimator = chapter_estimator(chapter_named("many_lights"));
    settings.seed = 1000;
    settings.samples = 64;
    expect_agreement(GetParam().name, shared, render_batches(scene, settings, light_path_batches), GetParam().limits);
}

}  // namespace
}  // namespace lab
