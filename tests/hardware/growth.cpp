#include "hardware/growth.h"

#include <cmath>

#include "benchmark/box_scene.h"
#include "support/dielectric_scenes.h"
#include "support/meshes.h"

namespace lab {
namespace {

constexpr uint32_t path_length = 8;

// The box with a sphere of about so many triangles.
Scene box_of(uint64_t triangles) {
    const auto rings = static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 4)));
    return make_box_scene(2 * rings, rings);
}

// The box with a lamp of so many triangles, about twice a square number.
Scene lamp_of(uint64_t triangles) {
    const auto cells = static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 2)));
    return make_box_scene(5, 3, cells);
}

// Spheres of 1012 triangles in a cube, which keeps its size.
Scene spheres(uint64_t count) {
    Scene scene = lit_scene(bumpy_sphere(23));
    const auto side = static_cast<uint64_t>(std::ceil(std::cbrt(static_cast<double>(count)) - 1e-9));
    const float cell = 3.0f / static_cast<float>(side);
    for (uint64_t i = 0; i < count; ++i) {
        const vec3 position(i % side, i / side % side, i / side / side);
        mat4x3 placement(0.4f * cell);
        placement[3] = cell * (position + 0.5f) - 1.5f;
        place(scene, placement);
    }
    return scene;
}

}  // namespace

std::vector<Growth> all_growths(uint32_t size) {
    const std::string roulette = "05_russian_roulette";
    const auto of = [size](Scene (*make)(uint64_t)) {
        return [=](uint64_t count) { return GrowthStep{make(count), uvec2(size), path_length}; };
    };
    const auto bounces = [size](uint64_t count) {
        return GrowthStep{empty_room(), uvec2(size), static_cast<uint32_t>(count)};
    };
    const auto pixels = [](uint64_t count) {
        const auto side = static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(count))));
        return GrowthStep{box_of(40'000), uvec2(side), path_length};
    };
    const std::vector<uint64_t> lengths{1, 2, 4, 8, 16, 32, 64};
    return {{"triangles", roulette, {100, 1'000, 10'000, 100'000, 1'000'000, 4'000'000}, of(box_of)},
            {"emissive triangles", roulette, {2, 10, 100, 1'000, 10'000, 100'000}, of(lamp_of)},
            {"instances", roulette, {1, 8, 64, 512, 4'096}, of(spheres)},
            {"pixels", roulette, {1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20, 1 << 22}, pixels},
            {"maximal path length without roulette", "03_next_event_estimation", lengths, bounces},
            {"maximal path length with roulette", roulette, lengths, bounces}};
}

}  // namespace lab
