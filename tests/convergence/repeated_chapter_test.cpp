// Chapters that are the chapter before them where what they add does not occur. Tests of such scenes leave
// them out (see support/render.h): what is proven for the one is proven for the other.
#include <cstdio>

#include "support/dielectric_scenes.h"
#include "support/render.h"

namespace lab {
namespace {

// The number of the chapter that is left out.
class RepeatedChapter : public testing::TestWithParam<uint32_t> {};
INSTANTIATE_TEST_SUITE_P(, RepeatedChapter, testing::ValuesIn(repeated_chapters),
                         [](const auto& instance) { return "chapter_" + std::to_string(instance.param); });

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
    Scene room = empty_room(), glossy = room, open = room, furnace = room;
    glossy.materials[0].specular_albedo = vec3(0.2f);
    glossy.materials[0].specular_exponent = 20;
    open.background = {0.2f, 0.3f, 0.5f};
    for (Material& material : furnace.materials) material.emission = vec3(1);
    for (const auto& [scene, light_sampling] : {std::pair{&room, LightSampling::on},
                                                {&glossy, LightSampling::on},
                                                {&open, LightSampling::on},
                                                {&furnace, LightSampling::off}}) {
        RenderSettings settings{.width = 48, .height = 48, .samples = 8, .seed = 7, .splitting_factor = 2};
        settings.light_sampling = light_sampling;
        settings.estimator = chapter_estimator(all_chapters.at(GetParam() - 1));
        SceneRenderer chapter(*scene, settings);
        settings.estimator = chapter_estimator(all_chapters.at(GetParam() - 2));
        SceneRenderer before(*scene, settings);
        constexpr uint32_t endless = 100'000;
        for (const auto& [length, roulette_start, cap, weight] : {std::tuple{0u, 1u, 0.95f, 1.0f},
                                                                  {1u, 1u, 0.95f, 1.0f},
                                                                  {8u, 1u, 0.95f, 0.25f},
                                                                  {endless, 3u, 0.95f, 0.5f},
                                                                  {endless, 1u, 0.5f, 1.0f}}) {
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
