// Ways to choose a lamp change the noise and not the picture, whichever strategy finds the light.
#include "support/agreement.h"
#include "support/expect_statistics.h"
#include "support/scenes.h"

namespace lab {
namespace {

// The camera looks at a wall behind the lamps: seen directly they would only add noise.
Scene room_with_lamps() {
    Scene scene = random_lamps(60, 3, 0.25f, box_sides(vec3(-1.5f), vec3(1.5f), 0, Facing::inwards));
    scene.camera = {.position = {0.2f, 0.1f, 1.26f}, .target = {0.2f, 0.1f, 2}, .up = {0, 1, 0}, .vertical_fov = 110};
    return scene;
}

Batches render_room(const Scene& scene, const std::string& choice, Strategy strategy, uint32_t samples, uint32_t seed) {
    RenderSettings settings{.width = 48,
                            .height = 48,
                            .samples = samples,
                            .max_path_length = 3,
                            .seed = seed,
                            .strategy = strategy,
                            .estimator = chapter_estimator(chapter_named("many_lights")),
                            .backend = fastest_backend()};
    settings.estimator.defines = {"LIGHT_CHOICE " + choice};
    return render_batches(scene, settings, 32);
}

TEST(LightChoices, AgreeWithEachOtherAndWithBounces) {
    const Scene scene = room_with_lamps();
    const Batches oracle = render_room(scene, "CHOOSES_BY_TREE", Strategy::both, 32, 3000);
    expect_agreement("bounces", render_room(scene, "CHOOSES_BY_TREE", Strategy::bounces, 192, 4000), oracle, {0.02, 0.35});
    expect_agreement("tree, light samples alone", render_room(scene, "CHOOSES_BY_TREE", Strategy::light, 16, 5000), oracle,
                     {0.01, 0.15});
    uint32_t seed = 6000;
    for (const std::string choice : {"CHOOSES_BY_POWER", "CHOOSES_UNIFORMLY"})
        for (const Strategy strategy : {Strategy::both, Strategy::light}) {
            const std::string what = choice + (strategy == Strategy::both ? ", both" : ", light samples alone");
            expect_agreement(what, render_room(scene, choice, strategy, 48, seed), oracle, {0.015, 0.2});
            seed += 1000;
        }
}

}  // namespace
}  // namespace lab
