// Scenes whose radiance is known exactly.
#include <cmath>

#include "support/expect_statistics.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

class Furnace : public OnEachChapter {};
INSTANTIATE_TEST_SUITE_P(Chapters, Furnace, testing::ValuesIn(all_chapters), own_estimator_name);

// Required samples: where everything is equally bright, all paths without roulette carry the same radiance, unless their angles
// are uniform. Russian roulette saves time, not variance, and low-discrepancy points need the fewest. Short paths vary less.
struct Samples {
    uint32_t with_uniform_angles, with_roulette, with_low_discrepancy;

    uint32_t of(const std::string& chapter, uint32_t length) const {
        const bool varies = has_roulette(chapter) || !weighs_by_albedo(chapter);
        if (length == 0 || !varies) return 16;
        const uint32_t most = !has_roulette(chapter)     ? with_uniform_angles
                              : is_pseudorandom(chapter) ? with_roulette
                                                         : with_low_discrepancy;
        return length == 1 ? most / 2 : most;
    }
};

// Inside a closed surface of albedo a and emission E every point shows E (1 + a + a² + ... + a^m) at path length m. Each channel
// has its own values.
void expect_furnace(const std::string& chapter, Scene (*make_furnace)(const Material&), const vec3& albedo, const vec3& emission,
                    const Samples& samples) {
    const Scene scene = make_furnace(diffuse_material(albedo, emission));
    // In a room whose walls all emit, light samples have infinite variance at the edges.
    RenderSettings settings{.strategy = Strategy::bounces, .estimator = chapter_estimator(chapter)};
    SceneRenderer renderer(scene, settings);
    for (const uint32_t m : {0u, 1u, 2u, 4u, 8u}) {
        settings.samples = samples.of(chapter, m);
        settings.max_path_length = m;
        settings.seed = chapter_seed(chapter) + m;
        const FilmImage film = renderer.render(settings).film;
        for (int channel = 0; channel < 3; ++channel) {
            const double a = albedo[channel], e = emission[channel];
            expect_mean("path length " + std::to_string(m) + ", " + channel_names[static_cast<size_t>(channel)],
                        estimate_mean(pixel_means(film, channel)), e * (1 - std::pow(a, m + 1)) / (1 - a), 0.002, 15);
        }
    }
}

TEST_P(Furnace, BoxShowsTheGeometricSeries) {
    expect_furnace(GetParam(), closed_box, {0.2f, 0.4f, 0.6f}, {1, 2, 0.5f}, {600, 2200, 1000});
}

// A convex object under a uniform sky shows its albedo times the sky at any path length above 0: light that it reflects never
// comes back.
TEST_P(Furnace, ConvexObjectShowsItsAlbedoTimesTheSky) {
    const vec3 albedo(0.9f, 0.4f, 0.15f), sky(1, 2, 3);
    Scene scene = make_sphere(diffuse_material(albedo), Facing::outwards);
    scene.background = sky;
    for (const uint32_t m : {1u, 8u}) {
        RenderSettings settings{.samples = 900, .max_path_length = m, .seed = chapter_seed(GetParam()) + 20 + m};
        settings.estimator = chapter_estimator(GetParam());
        const FilmImage film = render(scene, settings);
        for (int channel = 0; channel < 3; ++channel)
            expect_mean("path length " + std::to_string(m) + ", " + channel_names[static_cast<size_t>(channel)],
                        estimate_mean(pixel_means(film, channel)), double{albedo[channel]} * double{sky[channel]}, 0.002, 6);
    }
}

}  // namespace
}  // namespace lab
