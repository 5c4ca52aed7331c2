// Path lengths 0 and 1000, and surfaces that absorb nothing: no energy may be gained or lost on the way.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "hard_cases/probe.h"
#include "support/gpu_test.h"
#include "support/scenes.h"

namespace lab {
namespace {

class PathCases : public OnEachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, PathCases, testing::ValuesIn(all_backends), own_backend_name);

// Roulette never ends a path if surfaces absorb nothing and the survival probability may be 1.
RenderSettings make_settings(Backend backend, const std::string& chapter, uint32_t max_path_length) {
    RenderSettings settings{.width = 16, .height = 16, .samples = 4, .max_path_length = max_path_length};
    settings.survival_cap = 1;
    settings.strategy = Strategy::bounces;
    settings.estimator = chapter_estimator(chapter);
    settings.backend = backend;
    return settings;
}

TEST_P(PathCases, LengthZeroShowsTheEmission) {
    const vec3 emission(0.1f, 3, 1e6f);
    const Scene scene = closed_box(diffuse_material(vec3(1), emission));
    for (const std::string& chapter : chapters_for(GetParam(), all_chapters))
        for (const Strategy strategy : {Strategy::both, Strategy::bounces}) {
            RenderSettings settings = make_settings(GetParam(), chapter, 0);
            settings.strategy = strategy;
            settings.samples = 1;
            for (const FilmPixel& pixel : render(scene, settings).pixels) ASSERT_EQ(pixel.sum, emission) << chapter;
        }
}

TEST_P(PathCases, LengthThousandAddsAThousandAndOneEmissions) {
    // Inside a white box that emits 1, a path of chapter 2 or later keeps the weight 1. It ends early only if rounding errors
    // bring a direction below the surface, or if it escapes.
    constexpr uint32_t length = 1000;
    const Scene scene = closed_box(diffuse_material(vec3(1), vec3(1)));
    double largest_loss = 0;
    for (const std::string& chapter : chapters_for(GetParam(), chapters_that(weighs_by_albedo))) {
        const FilmImage film = render(scene, make_settings(GetParam(), chapter, length));
        double lost = 0;
        for (const double mean : pixel_means(film, 1)) {
            ASSERT_LE(mean, length + 1) << chapter;
            lost += 1 - mean / (length + 1);
        }
        largest_loss = std::max(largest_loss, lost / static_cast<double>(film.pixels.size()));
    }
    record("share_of_the_light_that_is_lost", "%.2g after 1000 bounces", largest_loss);
    EXPECT_LT(largest_loss, 1e-5 * length / 2);
}

TEST_P(PathCases, LengthThousandIsFiniteWithUniformAngles) {
    // The weights of chapter 1 vary, and the product of a thousand of them underflows or is huge: a useless estimate, but still a
    // number. render() fails the test if it is not.
    const Scene scene = closed_box(diffuse_material(vec3(1), vec3(1)));
    const FilmImage film = render(scene, make_settings(GetParam(), all_chapters.front(), 1000));
    for (const double mean : pixel_means(film, 1)) ASSERT_GE(mean, 1);
}

TEST_P(PathCases, WhiteConvexObjectVanishesBeforeAWhiteSky) {
    Scene scene = make_sphere(diffuse_material(vec3(1)), Facing::outwards);
    scene.background = vec3(1);
    size_t samples = 0, lost = 0;
    for (const vec3& scale : {vec3(1), vec3(100, 1, 1), vec3(1000, 1, 0.5f)})
        for (const std::string& chapter : chapters_for(GetParam(), chapters_that(weighs_by_albedo))) {
            if (scale != vec3(1) && chapter != chapter_named("cosine_sampling")) continue;  // bounces are the same in all of them
            set_transform(scene, mat4x3(glm::scale(glm::mat4(1), scale)));
            RenderSettings settings = make_settings(GetParam(), chapter, 1000);
            settings.samples = 256;
            for (const FilmPixel& pixel : render(scene, settings).pixels) {
                ASSERT_EQ(pixel.sum.r, std::floor(pixel.sum.r)) << "samples are 1, or 0 where dropped";
                ASSERT_LE(pixel.sum.r, static_cast<float>(pixel.sample_count));
                lost += pixel.sample_count - static_cast<size_t>(pixel.sum.r);
                samples += pixel.sample_count;
            }
        }
    record("samples_that_are_not_exactly_1", "%zu of %zu", lost, samples);
    EXPECT_LE(lost, samples / 100'000);
}

}  // namespace
}  // namespace lab
