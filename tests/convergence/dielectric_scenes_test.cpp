// Chapter 6 in lit scenes, against other ways to compute the same image, and in scenes that are numerically hard.
#include "support/dielectric_scenes.h"

#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>

#include "support/agreement.h"
#include "support/expect_statistics.h"
#include "support/render.h"

namespace lab {
namespace {

RenderSettings room_settings(uint32_t samples, uint32_t seed) {
    return {.width = 48,
            .height = 48,
            .samples = samples,
            .max_path_length = 1000,  // practically unlimited: roulette ends paths much earlier
            .seed = seed,
            .roulette_start = 3,
            .estimator = chapter_estimator(chapter_named("dielectrics"))};
}

constexpr uint32_t scene_batches = 32;

TEST(DielectricScene, LightSamplingKeepsTheMean) {
    Material glass = dielectric_material(1.5f, {0.5f, 0.2f, 0.8f});
    const Scene clear = room_with_box(glass), filled = glass_with_lamp(glass);
    glass.emission = {1, 2, 0.5f};
    const Scene emissive = room_with_box(glass);
    const std::pair<const char*, const Scene*> scenes[] = {
        {"glass box", &clear}, {"emissive glass box", &emissive}, {"lamp in glass", &filled}};
    for (const auto& [name, scene] : scenes) {
        RenderSettings off = room_settings(20, 4);
        off.strategy = Strategy::bounces;
        expect_agreement(name, render_batches(*scene, room_settings(14, 3), scene_batches),
                         render_batches(*scene, off, scene_batches), {0.02, 0.3});
    }
}

TEST(DielectricScene, BranchesAndRouletteKeepTheMean_all) {
    const Scene scene = room_with_box(dielectric_material(1.5f, {0.5f, 0.2f, 0.8f}));
    RenderSettings split = room_settings(5, 6);
    split.splitting_factor = 3;
    split.roulette_start = 1;
    RenderSettings plain = room_settings(9, 5);
    plain.roulette_start = 20;
    expect_agreement("splitting and early roulette", render_batches(scene, split, scene_batches),
                     render_batches(scene, plain, scene_batches), {0.02, 0.3});
}

TEST(DielectricScene, EmissiveGlassAddsItsEmissionOnce) {
    Material glass = dielectric_material(1.5f);
    glass.emission = {3, 2, 1};
    Scene scene = make_sphere(glass, Facing::outwards);
    scene.background = vec3(1);
    for (const Strategy strategy : {Strategy::both, Strategy::bounces}) {
        RenderSettings settings = room_settings(50, 8);
        settings.strategy = strategy;
        settings.roulette_start = 1000;
        const FilmImage film = render(scene, settings);
        for (int channel = 0; channel < 3; ++channel)
            expect_mean("channel " + std::to_string(channel), estimate_mean(pixel_means(film, channel)),
                        1 + double{glass.emission[channel]}, 0.001, 6);
    }
}

// Scenes in which surfaces touch, coincide or enclose the camera: render() expects all samples to be finite, and the image may be
// no brighter than its lamp seen through glass.
TEST(DielectricScene, TouchingSurfacesStayFinite) {
    const Material glass = dielectric_material(1.5f, {0.1f, 0.2f, 0.3f});
    const Material lamp = diffuse_material(vec3(0.5f), vec3(1));
    const Quad lamp_quad{{-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, 0};
    const struct {
        const char* name;
        vec3 low, high;  // of a glass box
        vec3 camera;
    } cases[] = {
        {"a face in the plane of the lamp", {-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}, {0, 0.5f, 3}},
        {"the lamp inside the glass", {-1, 0, -1}, {1, 2, 1}, {0, 0.5f, 3}},
        {"an edge on the lamp", {0, 0, 0}, {1, 1, 1}, {0, 0.5f, 3}},
        {"the camera in the glass", {-0.5f, 0, -0.5f}, {0.5f, 0.9f, 0.5f}, {0, 0.5f, 0.2f}},
        {"the camera on a face", {-0.5f, 0, -0.5f}, {0.5f, 0.9f, 0.5f}, {0, 0.5f, 0.5f}},
        {"a box without height", {-0.5f, 0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, {0, 1, 3}},
    };
    for (const auto& [name, low, high, camera] : cases) {
        std::vector<Quad> quads{lamp_quad, {{-2, -0.01f, -2}, {0, 0, 4}, {4, 0, 0}, 1}};
        for (const Quad& side : box_sides(low, high, 2, Facing::outwards))
            if (glm::cross(side.edge_u, side.edge_v) != vec3(0)) quads.push_back(side);
        Scene scene = make_scene({lamp, diffuse_material(vec3(0.7f)), glass}, quads);
        scene.background = vec3(0.1f);
        scene.camera = {.position = camera, .target = {0, 0.4f, -1}, .up = {0, 1, 0}, .vertical_fov = 50};
        const FilmImage film = render(scene, room_settings(25, 9));
        const std::vector<double> means = pixel_means(film, 0);
        const double mean = std::accumulate(means.begin(), means.end(), 0.0) / static_cast<double>(means.size());
        std::printf("  %s: mean radiance %.3f\n", name, mean);
        EXPECT_GT(mean, 0.01) << name;
        EXPECT_LT(mean, 2.25 * 1.1) << name;
    }
}

}  // namespace
}  // namespace lab
