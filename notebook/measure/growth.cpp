#include "measure/growth.h"

#include <cmath>

#include "measure/box_scene.h"
#include "support/chapters.h"
#include "support/dielectric_scenes.h"
#include "support/scenes.h"

namespace lab {
namespace {

constexpr uint32_t path_length = 8;

// The box with a sphere, about this many triangles in all.
Scene box_of(uint64_t triangles) {
    const auto rings = static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 4)));
    return make_box_scene(2 * rings, rings);
}

// Spheres of 1012 triangles each in a cube of constant size.
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
    const std::string roulette = chapter_named("russian_roulette");
    const auto triangles = [size](uint64_t count) {
        const Scene scene = box_of(count);
        return GrowthStep{scene.triangles.size(), scene, uvec2(size), path_length};
    };
    const auto lights = [size](uint64_t count) {
        const auto cells = static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(count) / 2)));
        return GrowthStep{2 * uint64_t{cells} * cells, make_box_scene(5, 3, cells), uvec2(size), path_length};
    };
    const auto instances = [size](uint64_t count) { return GrowthStep{count, spheres(count), uvec2(size), path_length}; };
    const auto pixels = [](uint64_t count) {
        const auto side = static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(count))));
        return GrowthStep{count, box_of(40'000), uvec2(side), path_length};
    };
    const auto bounces = [size](uint64_t count) {
        return GrowthStep{count, empty_room(), uvec2(size), static_cast<uint32_t>(count)};
    };
    const std::vector<uint64_t> lengths{1, 2, 4, 8, 16, 32, 64};
    return {{"triangles", roulette, {100, 1'000, 10'000, 100'000, 1'000'000, 4'000'000}, triangles},
            {"emissive triangles", roulette, {2, 10, 100, 1'000, 10'000, 100'000}, lights},
            {"instances", roulette, {1, 8, 64, 512, 4'096}, instances},
            {"pixels", roulette, {1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20, 1 << 22}, pixels},
            {"maximal path length without roulette", chapter_named("next_event_estimation"), lengths, bounces},
            {"maximal path length with roulette", roulette, lengths, bounces}};
}

}  // namespace lab
