// Chapters that are another one, path by path, where what they add does not occur. Tests of such scenes leave
// them out (see support/render.h): what is proven for the one is proven for the other.
#include <cstdio>
#include <tuple>

#include "files/project_folder.h"
#include "support/dielectric_scenes.h"
#include "support/render.h"

namespace lab {
namespace {

struct Repetition {
    std::string name;
    uint32_t chapter, before;
    uint32_t splitting_factor = 2;
    bool has_roulette = true;
    bool has_glass = true, has_probe = false;
    bool has_points = true;  // instead of random numbers, where the chapter has them
};
const std::vector<Repetition> repetitions{
    {.name = "chapter_4_without_splitting",
     .chapter = 4,
     .before = 3,
     .splitting_factor = 1,
     .has_roulette = false,
     .has_glass = false},
    {.name = "chapter_5_without_roulette",
     .chapter = 5,
     .before = 4,
     .has_roulette = false,
     .has_glass = false},
    {.name = "chapter_6_without_glass", .chapter = 6, .before = 5, .has_glass = false},
    {.name = "chapter_8_without_probe", .chapter = 8, .before = 7},
    {.name = "chapter_9_without_its_points",
     .chapter = 9,
     .before = 8,
     .has_probe = true,
     .has_points = false},
    {.name = "chapter_10", .chapter = 10, .before = 9, .has_probe = true}};

class RepeatedChapter : public testing::TestWithParam<size_t> {};
INSTANTIATE_TEST_SUITE_P(, RepeatedChapter, testing::Range(size_t{0}, repetitions.size()),
                         [](const auto& instance) { return repetitions[instance.param].name; });

Estimator repetition_estimator(const Repetition& repetition) {
    Estimator estimator = chapter_estimator(all_chapters.at(repetition.chapter - 1));
    if (repetition.has_points) return estimator;
    estimator.observed = estimator.file;
    estimator.file = project_folder() / "tests" / "shaders" / "without_points.glsl";
    std::erase(estimator.defines, "LOW_DISCREPANCY");
    return estimator;
}

// Rooms to be rendered, and whether light samples find the light in them.
std::vector<std::pair<Scene, Strategy>> scenes_of(const Repetition& repetition) {
    const Scene room = empty_room();
    Scene glossy = room, open = room, furnace = room;
    glossy.materials[0].specular_albedo = vec3(0.2f);
    glossy.materials[0].specular_exponent = 20;
    open.background = {0.2f, 0.3f, 0.5f};
    for (Material& material : furnace.materials) material.emission = vec3(1);
    std::vector<std::pair<Scene, Strategy>> scenes{{room, Strategy::both},
                                                        {glossy, Strategy::both},
                                                        {open, Strategy::both},
                                                        {furnace, Strategy::bounces}};
    if (repetition.has_glass)
        scenes.emplace_back(room_with_box(dielectric_material(1.5f, vec3(0.3f))), Strategy::both);
    if (repetition.has_probe) scenes.emplace_back(load_shipped_scene("textured.json"), Strategy::both);
    return scenes;
}

// Down to the random numbers. Only the rounding of sums may differ, where a compiler contracts them, and then
// a few paths by roulette.
void expect_same_paths(const Rendering& chapter, const Rendering& before) {
    size_t equal = 0, close = 0;
    const auto& expected = before.film.pixels;
    for (size_t i = 0; i < expected.size(); ++i) {
        const vec3 sum = chapter.film.pixels[i].sum;
        equal += sum == expected[i].sum;
        close += glm::distance(sum, expected[i].sum) <= 1e-5f * glm::length(expected[i].sum);
    }
    std::printf("  %zu of %zu pixels are equal to the bit, %zu up to roundings\n", equal, expected.size(),
                close);
    EXPECT_GE(close, expected.size() * 99 / 100);
    const double rays = static_cast<double>(before.rays);
    EXPECT_NEAR(static_cast<double>(chapter.rays), rays, 1e-3 * rays);
}

TEST_P(RepeatedChapter, IsTheChapterBeforeIt) {
    const Repetition& repetition = repetitions[GetParam()];
    constexpr uint32_t endless = 100'000;
    std::vector<std::tuple<uint32_t, uint32_t, float, float>> limits{
        {0, no_roulette, 1.0f, 1.0f}, {1, no_roulette, 1.0f, 1.0f}, {8, no_roulette, 1.0f, 1.0f}};
    if (repetition.has_roulette)
        limits = {{0, 1, 0.95f, 1.0f},
                  {1, 1, 0.95f, 1.0f},
                  {8, 1, 0.95f, 0.25f},
                  {endless, 3, 0.95f, 0.5f},
                  {endless, 1, 0.5f, 1.0f}};
    for (const auto& [scene, strategy] : scenes_of(repetition)) {
        RenderSettings settings{.width = 48,
                                .height = 48,
                                .samples = 8,
                                .seed = 7,
                                .splitting_factor = repetition.splitting_factor,
                                .strategy = strategy,
                                .estimator = repetition_estimator(repetition)};
        SceneRenderer chapter(scene, settings);
        settings.estimator = chapter_estimator(all_chapters.at(repetition.before - 1));
        SceneRenderer before(scene, settings);
        for (const auto& [length, roulette_start, cap, weight] : limits) {
            settings.max_path_length = length;
            settings.roulette_start = roulette_start;
            settings.survival_cap = cap;
            settings.survival_weight = weight;
            expect_same_paths(chapter.render(settings), before.render(settings));
        }
    }
}

}  // namespace
}  // namespace lab
