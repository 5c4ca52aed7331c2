// The live verdict on the chapters, as the viewer shows it during a render.
#include "statistics/live_verdict.h"

#include <cstdio>
#include <variant>

#include "rendering/scene_reference.h"
#include "support/gpu_test.h"
#include "support/render.h"

namespace lab {
namespace {

RenderParameters parameters_for(const Scene& scene, uint32_t max_path_length, uint32_t seed) {
    RenderSettings settings{.width = 128, .height = 128, .max_path_length = max_path_length, .seed = seed};
    settings.splitting_factor = 2;
    return make_parameters(scene, settings);
}

class LiveVerdictOf : public OnEachChapter {
  protected:
    static void expect_agreement(uint32_t seeds);
};
INSTANTIATE_TEST_SUITE_P(, LiveVerdictOf, testing::ValuesIn(all_chapters), own_estimator_name);

void LiveVerdictOf::expect_agreement(uint32_t seeds) {
    const Scene scene = load_shipped_scene("cornell_box.json");
    const GpuScene gpu_scene(test_device(), scene);
    const auto scene_backend = compute_backend->build(test_device(), gpu_scene);
    // Bounces find the light by chance: direct light is enough.
    const uint32_t max_path_length = samples_lights(GetParam()) ? 6 : 1;
    RenderParameters parameters = parameters_for(scene, max_path_length, 1);
    Renderer renderer(test_device(), *scene_backend, chapter_estimator(GetParam()), parameters);
    for (uint32_t seed = 1; seed <= seeds; ++seed) {
        parameters.seed_key = seed_key(test_seed(chapter_seed(GetParam()) + seed));
        renderer.restart(parameters);
        const auto reference = find_reference(scene, parameters);
        ASSERT_TRUE(std::holds_alternative<Reference>(reference)) << std::get<std::string>(reference);
        LiveVerdict verdict(std::get<Reference>(reference), parameters.image_size);
        while (verdict.next_samples() <= 32) {
            while (renderer.advance(verdict.next_samples())) {
            }
            verdict.add(renderer.film().read());
        }
        std::printf("  seed %u: %s\n", seed, verdict.text().c_str());
        EXPECT_FALSE(verdict.verdict()->is_biased) << verdict.text();
        for (const double smallest : verdict.verdict()->smallest_detectable) EXPECT_LT(smallest, 0.15);
    }
}

TEST_P(LiveVerdictOf, AgreesWithTheReference) { expect_agreement(2); }
TEST_P(LiveVerdictOf, AgreesWithTheReferenceForManySeeds_all) { expect_agreement(40); }

std::string why_not(const Scene& scene, const RenderParameters& parameters) {
    const auto reference = find_reference(scene, parameters);
    return std::holds_alternative<Reference>(reference) ? "" : std::get<std::string>(reference);
}

TEST(SceneReference, IsThatOfTheSameImageOnly) {
    Scene scene = load_shipped_scene("cornell_box.json");
    const RenderParameters good = parameters_for(scene, 6, 1);
    EXPECT_EQ(why_not(scene, good), "");
    EXPECT_EQ(why_not(scene, parameters_for(scene, 5, 1)), "this scene's references are for a maximal path length of 1 and 6");
    RenderParameters changed = good;
    changed.camera.position.x += 0.01f;
    EXPECT_EQ(why_not(scene, changed), "the camera has changed");
    changed = good;
    changed.background = vec3(1);
    EXPECT_EQ(why_not(scene, changed), "the background is not the scene's");
    changed = good;
    changed.only_path_length = 6;
    EXPECT_EQ(why_not(scene, changed), "the picture shows a single path length");
    changed = good;
    changed.image_size = {200, 200};
    EXPECT_EQ(why_not(scene, changed), "the reference has 128x128 pixels, the image is no whole number of times larger");
    scene.hash ^= 1;
    EXPECT_EQ(why_not(scene, good), "this scene's reference is older than the scene: ./lab reference --all");
    EXPECT_EQ(why_not(load_shipped_scene("furnace.json"), good), "this scene has no reference");
}

}  // namespace
}  // namespace lab
