// The error falls with the square root of the number of samples. A slower fall reveals correlated samples, repeating seeds or
// infinite variance. With low-discrepancy points it falls faster.
#include <cmath>
#include <cstdio>

#include "files/project_folder.h"
#include "statistics/error_metrics.h"
#include "support/error_slope.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/scenes.h"

namespace lab {
namespace {

// Expects a chapter's error to fall with the root of the number of samples; a slope that is off by 0.07 would have been found.
void expect_slope(const Scene& scene, const std::string& chapter, RenderSettings settings) {
    settings.splitting_factor = 2;
    settings.roulette_start = 2;
    settings.estimator = chapter_estimator(chapter);
    settings.seed = chapter_seed(chapter);
    const ErrorSlope slope = measure_error_slope(scene, settings, 1024);
    // A slope outside the tolerance is found with this probability.
    const double finds = slope_tolerance + normal_quantile(power) * slope.standard_error;
    std::printf("  variance of a sample, from 1, 4, 16 ... samples:%s\n  slope %.4f; finds one off by %.3f\n",
                slope.variances.c_str(), slope.value, finds);
    EXPECT_NEAR(slope.value, -0.5, slope_tolerance);
    EXPECT_LT(slope.standard_error, largest_slope_error) << "the test is too weak, take larger images";
}

class Convergence : public OnEachChapter {};
INSTANTIATE_TEST_SUITE_P(Chapters, Convergence, testing::ValuesIn(chapters_that(is_pseudorandom)), own_estimator_name);
TEST_P(Convergence, ErrorFallsWithTheRootOfTheNumberOfSamples) {
    Scene scene = load_shipped_scene("cornell_box.json");
    // Without the lamp: a few pixels at its edge would dominate the error of the whole image.
    scene.camera.target = {0, 0.7f, 0};
    scene.camera.vertical_fov = 22;
    expect_slope(scene, GetParam(), {.width = 44, .height = 44, .max_path_length = 3});
}

// Whatever correlates samples does so in either scene.
TEST_P(Convergence, ErrorUnderASkyFallsWithTheRootOfTheNumberOfSamples_all) {
    expect_slope(load_shipped_scene("textured.json"), GetParam(), {.width = 48, .height = 48, .max_path_length = 2});
}

// --- Low-discrepancy points.

// The largest slope allowed for a log-log line through the errors of 1, 4, 16, … samples.
void expect_slope_below(const std::string& what, const std::vector<double>& errors, double largest) {
    double xy = 0, xx = 0;
    std::string text;
    for (size_t i = 0; i < errors.size(); ++i) {
        const double x = static_cast<double>(i) - 0.5 * static_cast<double>(errors.size() - 1);
        xy += x * std::log(errors[i]) / std::log(4);
        xx += x * x;
        text += " " + std::to_string(errors[i]);
    }
    std::printf("  %s: slope %.3f; errors%s\n", what.c_str(), xy / xx, text.c_str());
    EXPECT_LT(xy / xx, largest) << what;
}

// For smooth functions with known integrals. If pixels shared a scramble they would err together, and their mean would be no
// better than each of them. If pairs of numbers shared one, the integral would be wrong.
TEST(LowDiscrepancyConvergence, ErrorOfSmoothIntegralsFallsFast) {
    const Estimator chapter = chapter_estimator(chapter_named("low_discrepancy_points"));
    RenderSettings settings{.width = 64, .height = 64, .seed = test_seed(9100)};
    settings.estimator = {.file = project_folder() / "tests" / "shaders" / "smooth_radiance.glsl",
                          .defines = chapter.defines,
                          .observed = chapter.file};
    SceneRenderer renderer(closed_box(diffuse_material(vec3(0.5f))), settings);
    // The pairs are unrelated: what depends on two of them converges more slowly.
    for (const auto& [channel, largest_slope] : {std::pair{0, -0.9}, {1, -0.9}, {2, -0.55}}) {
        std::vector<double> by_samples, by_pixels;
        for (settings.samples = 1; settings.samples <= 1024; settings.samples *= 4) {
            double square = 0;
            for (const double mean : pixel_means(renderer.render(settings).film, channel)) square += (mean - 1) * (mean - 1);
            by_samples.push_back(std::sqrt(square / (settings.width * settings.height)));
        }
        settings.samples = 64;
        const auto means = pixel_means(renderer.render(settings).film, channel);
        for (size_t pixels = 1; pixels <= 64; pixels *= 4) {
            double square = 0;
            for (size_t first = 0; first < means.size(); first += pixels) {
                double sum = 0;
                for (size_t i = first; i < first + pixels; ++i) sum += means[i] - 1;
                square += sum * sum / static_cast<double>(pixels * pixels);
            }
            by_pixels.push_back(std::sqrt(square * static_cast<double>(pixels) / static_cast<double>(means.size())));
        }
        expect_slope_below("samples, function " + std::to_string(channel), by_samples, largest_slope);
        expect_slope_below("pixels, function " + std::to_string(channel), by_pixels, -0.44);
    }
}

void expect_fast_convergence(const Scene& scene, RenderSettings settings, double largest_slope) {
    settings.seed = 9200;
    const ErrorSlope slope = measure_error_slope(scene, settings, 1024);
    std::printf("  variance of a sample, from 1, 4, 16 ... samples:%s\n  slope %.4f ± %.4f\n", slope.variances.c_str(),
                slope.value, slope.standard_error);
    EXPECT_LT(slope.value + 5 * slope.standard_error, largest_slope);
}

// A square lamp above a floor, with nothing to block its light.
Scene lamp_above_floor() {
    Scene scene = make_scene({diffuse_material(vec3(0.8f)), diffuse_material(vec3(0), vec3(5))},
                             {{{-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, 0}, {{-0.5f, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, 1}});
    scene.camera = {.position = {0, 1, 3}, .target = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 25};
    return scene;
}

RenderSettings light_samples_only() {
    RenderSettings settings{.width = 48, .height = 48, .max_path_length = 1};
    settings.estimator = chapter_estimator(chapter_named("low_discrepancy_points"));
    settings.estimator.defines.emplace_back("STRATEGY STRATEGY_LIGHT");
    return settings;
}

TEST(LowDiscrepancyConvergence, ErrorOfUnoccludedDirectLightFallsFast) {
    expect_fast_convergence(lamp_above_floor(), light_samples_only(), -0.7);
}

TEST(LowDiscrepancyConvergence, ErrorOfWholePicturesFallsFaster_all) {
    RenderSettings settings{.width = 48, .height = 48, .max_path_length = 3, .roulette_start = 3};
    settings.estimator = chapter_estimator(chapter_named("low_discrepancy_points"));
    expect_fast_convergence(load_shipped_scene("cornell_box.json"), settings, -0.52);
}

// What reports, --target-error and noise maps rely on: the difference between the halves of the samples estimates the error of
// their mean, which the spread over seeds shows as well. Halves of a single sequence would fill each other's gaps. So they would
// differ more than their mean errs, and the estimate would be several times too large.
TEST(LowDiscrepancyConvergence, HalvesTellTheError) {
    constexpr uint32_t seeds = 24;
    RenderSettings settings = light_samples_only();
    settings.samples = 33;
    SceneRenderer renderer(lamp_above_floor(), settings);
    std::vector<Image> means;
    std::vector<double> estimated, actual;
    for (settings.seed = 9300; settings.seed < 9300 + seeds; ++settings.seed) {
        const FilmImage film = renderer.render(settings).film;
        estimated.push_back(estimate_error(film)->mse);
        means.push_back(film.mean());
    }
    for (const Image& mean : means) {
        double sum = 0;
        for (size_t i = 0; i < mean.pixels.size(); ++i) {
            double expected = 0;
            for (const Image& other : means) expected += double{other.pixels[i]} / seeds;
            sum += (mean.pixels[i] - expected) * (mean.pixels[i] - expected);
        }
        actual.push_back(sum / static_cast<double>(mean.pixels.size()) * seeds / (seeds - 1));
    }
    const MeanEstimate estimate = estimate_mean(estimated), truth = estimate_mean(actual);
    const double ratio = estimate.mean / truth.mean,
                 error = ratio * std::hypot(estimate.standard_error / estimate.mean, truth.standard_error / truth.mean);
    constexpr double tolerance = 0.1;
    std::printf("  estimated over actual error: %.4f ± %.4f; finds one off by %.3f\n", ratio, error,
                tolerance + normal_quantile(power) * error);
    EXPECT_NEAR(ratio, 1, tolerance);
    EXPECT_LT(error, tolerance / 6) << "the test is too weak, take larger images";
}

// The fraction of tiles of 8 x 8 pixels whose mean is within 1.96 standard errors, estimated from the halves, of its expected
// value.
double part_within_the_error_bar(const FilmImage& film, const Image& expected) {
    constexpr uint32_t tile = 8;
    uint32_t within = 0, count = 0;
    for (uint32_t top = 0; top < film.height; top += tile)
        for (uint32_t left = 0; left < film.width; left += tile) {
            glm::dvec3 error(0), variance(0);
            for (uint32_t i = 0; i < tile * tile; ++i) {
                const size_t pixel = size_t{top + i / tile} * film.width + left + i % tile;
                const FilmPixel& values = film.pixels[pixel];
                const float* mean = &expected.pixels[3 * pixel];
                error += sum_of(values) / static_cast<double>(values.sample_count) - glm::dvec3(mean[0], mean[1], mean[2]);
                variance += variance_of_mean(values);
            }
            for (int channel = 0; channel < 3; ++channel, ++count)
                within += std::abs(error[channel]) < 1.96 * std::sqrt(variance[channel]);
        }
    return static_cast<double>(within) / count;
}

// At powers of two, where the points are at their best, and at other numbers of samples.
void expect_error_bars_to_hold(const Scene& scene, RenderSettings settings, uint32_t seeds, const Image& expected) {
    SceneRenderer renderer(scene, settings);
    for (const uint32_t samples : {50u, 64u, 100u, 1000u}) {
        settings.samples = samples;
        double part = 0;
        for (uint32_t i = 0; i < seeds; ++i) {
            settings.seed = test_seed(9500 + i);
            part += part_within_the_error_bar(renderer.render(settings).film, expected) / seeds;
        }
        std::printf("  %u samples: %.1f %% of the error bars hold\n", samples, 100 * part);
        EXPECT_GT(part, 0.93) << samples << " samples";
        EXPECT_LT(part, 0.97) << samples << " samples";
    }
}

// For smooth functions with integral 1: there points gain most, and dependent halves would be most misleading.
TEST(LowDiscrepancyConvergence, ErrorBarsHoldAtAnyNumberOfSamples) {
    const Estimator chapter = chapter_estimator(chapter_named("low_discrepancy_points"));
    RenderSettings settings{.width = 64, .height = 64};
    settings.estimator = {.file = project_folder() / "tests" / "shaders" / "smooth_radiance.glsl",
                          .defines = chapter.defines,
                          .observed = chapter.file};
    expect_error_bars_to_hold(closed_box(diffuse_material(vec3(0.5f))), settings, 12,
                              {64, 64, std::vector<float>(3 * 64 * 64, 1.0f)});
}

}  // namespace
}  // namespace lab
