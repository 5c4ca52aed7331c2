// Chapters that follow the same paths as an earlier one wherever their own feature is absent. Tests of such scenes skip them (see
// support/render.h): a proof for one chapter holds for the other.
#include <cstdio>
#include <tuple>

#include "files/project_folder.h"
#include "support/dielectric_scenes.h"
#include "support/render.h"

namespace lab {
namespace {

// From "tests" in the chapters' chapter.json.
const std::vector<Repetition> repeated_chapters = repetitions();

class RepeatedChapter : public testing::TestWithParam<size_t> {};
INSTANTIATE_TEST_SUITE_P(, RepeatedChapter, testing::Range(size_t{0}, repeated_chapters.size()),
                         [](const auto& instance) { return "chapter_" + repeated_chapters[instance.param].chapter; });

// Rooms to render, and whether light samples find the light in them.
std::vector<std::pair<Scene, Strategy>> scenes_of(const Repetition& repetition) {
    const Scene room = empty_room();
    Scene glossy = room, open = room, furnace = room;
    glossy.materials[0].specular_albedo = vec3(0.2f);
    glossy.materials[0].specular_exponent = 20;
    open.background = {0.2f, 0.3f, 0.5f};
    for (Material& material : furnace.materials) material.emission = vec3(1);
    std::vector<std::pair<Scene, Strategy>> scenes{
        {room, Strategy::both}, {glossy, Strategy::both}, {open, Strategy::both}, {furnace, Strategy::bounces}};
    if (repetition.has("glass")) scenes.emplace_back(room_with_box(dielectric_material(1.5f, vec3(0.3f))), Strategy::both);
    if (repetition.has("probe")) scenes.emplace_back(load_shipped_scene("textured.json"), Strategy::both);
    return scenes;
}

// Down to the random numbers. Only the rounding of sums may differ where a compiler contracts them, and hence the roulette of a
// few paths.
void expect_same_paths(const Rendering& chapter, const Rendering& before) {
    size_t equal = 0, close = 0;
    const auto& expected = before.film.pixels;
    for (size_t i = 0; i < expected.size(); ++i) {
        const vec3 sum = chapter.film.pixels[i].sum;
        equal += sum == expected[i].sum;
        close += glm::distance(sum, expected[i].sum) <= 1e-5f * glm::length(expected[i].sum);
    }
    std::printf("  %zu of %zu pixels are equal to the bit, %zu up to roundings\n", equal, expected.size(), close);
    EXPECT_GE(close, expected.size() * 99 / 100);
    const double rays = static_cast<double>(before.rays);
    EXPECT_NEAR(static_cast<double>(chapter.rays), rays, 1e-3 * rays);
}

TEST_P(RepeatedChapter, IsTheChapterBeforeIt) {
    const Repetition& repetition = repeated_chapters[GetParam()];
    constexpr uint32_t endless = 100'000;
    std::vector<std::tuple<uint32_t, uint32_t, float, float>> limits{
        {0, no_roulette, 1.0f, 1.0f}, {1, no_roulette, 1.0f, 1.0f}, {8, no_roulette, 1.0f, 1.0f}};
    if (repetition.has("roulette"))
        limits = {
            {0, 1, 0.95f, 1.0f}, {1, 1, 0.95f, 1.0f}, {8, 1, 0.95f, 0.25f}, {endless, 3, 0.95f, 0.5f}, {endless, 1, 0.5f, 1.0f}};
    for (const auto& [scene, strategy] : scenes_of(repetition)) {
        RenderSettings settings{.width = 48,
                                .height = 48,
                                .samples = 8,
                                .seed = 7,
                                .splitting_factor = repetition.has("splitting") ? 2u : 1u,
                                .strategy = strategy,
                                .estimator = chapter_estimator(repetition.chapter)};
        SceneRenderer chapter(scene, settings);
        settings.estimator = chapter_estimator(repetition.before);
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
