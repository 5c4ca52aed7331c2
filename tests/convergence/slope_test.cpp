// The error falls with the square root of the number of samples. A slower fall tells of samples that depend
// on each other, of seeds that repeat or of an infinite variance.
#include <array>
#include <cmath>
#include <cstdio>

#include "support/expect_statistics.h"
#include "support/render.h"

namespace lab {
namespace {

constexpr uint32_t size = 56;

// The mean square of the difference of two renders with seeds of their own: twice the variance of a pixel.
// Its logarithm, and the standard error of that by the jackknife over 16 interleaved groups of pixels.
struct LogError {
    double value, standard_error;
};

LogError log_error(const FilmImage& first, const FilmImage& second) {
    constexpr size_t groups = 16;
    std::array<double, groups> sums{};
    for (int channel = 0; channel < 3; ++channel) {
        const auto a = pixel_means(first, channel), b = pixel_means(second, channel);
        // Neighbours belong to different groups; 7 has no factor in common with the width.
        for (size_t i = 0; i < a.size(); ++i) sums[i * 7 % groups] += std::pow(a[i] - b[i], 2);
    }
    double total = 0;
    for (const double sum : sums) total += sum;
    std::array<double, groups> without{};
    for (size_t group = 0; group < groups; ++group)
        without[group] = std::log((total - sums[group]) * groups / (groups - 1));
    const double variance = estimate_mean(without).variance * (groups - 1) * (groups - 1) / groups;
    return {std::log(total / (3.0 * size * size)), std::sqrt(variance)};
}

class Convergence : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Chapters, Convergence, testing::ValuesIn(all_chapters), chapter_name);

TEST_P(Convergence, ErrorFallsWithTheRootOfTheNumberOfSamples) {
    Scene scene = load_shipped_scene("cornell_box.json");
    // Without the lamp: a few pixels at its edge would decide the error of the whole image.
    scene.camera.target = {0, 0.7f, 0};
    scene.camera.vertical_fov = 22;
    // Least squares of the logarithms of the errors, each weighted by its own variance.
    double weights = 0, x_sum = 0, y_sum = 0, xx_sum = 0, xy_sum = 0;
    std::string errors;
    uint32_t seed = 1000 * chapter_number(GetParam());
    for (uint32_t samples = 1; samples <= 1024; samples *= 4) {
        RenderSettings settings{.width = size, .height = size, .samples = samples, .max_path_length = 3};
        settings.splitting_factor = 2;
        settings.estimator = chapter_estimator(GetParam());
        settings.seed = ++seed;
        const FilmImage first = render(scene, settings);
        settings.seed = ++seed;
        const LogError error = log_error(first, render(scene, settings));
        const double x = std::log(samples), y = 0.5 * error.value;
        const double weight = 1 / std::pow(0.5 * error.standard_error, 2);
        weights += weight;
        x_sum += weight * x;
        y_sum += weight * y;
        xx_sum += weight * x * x;
        xy_sum += weight * x * y;
        errors += " " + std::to_string(std::exp(error.value) * samples / 2);
    }
    const double spread = xx_sum - x_sum * x_sum / weights;
    const double slope = (xy_sum - x_sum * y_sum / weights) / spread;
    // A slope that leaves the tolerance with this probability.
    constexpr double tolerance = 0.05;
    const double finds = tolerance + normal_quantile(power) / std::sqrt(spread);
    std::printf("  variance of a sample, from 1, 4, 16 ... samples:%s\n  slope %.4f; finds one off by %.3f\n",
                errors.c_str(), slope, finds);
    EXPECT_NEAR(slope, -0.5, tolerance);
    EXPECT_LT(finds, 0.07) << "the test is too weak, take larger images";
}

}  // namespace
}  // namespace lab
