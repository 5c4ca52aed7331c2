// Chapter 4: with s branches a sample has the variance V_out + V_in / s, and Russian roulette is unaffected by them.
#include <cmath>

#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

const std::vector<uint32_t> splitting_factors{1, 2, 4, 8};

// The variance of single samples of a pixel, averaged over the pixels: independent estimates, one from each `group` of batches,
// which must have one sample each.
std::vector<double> sample_variances(const Batches& batches, size_t group) {
    std::vector<double> variances;
    for (size_t first = 0; first + group <= batches.images.size(); first += group) {
        const size_t pixels = batches.images[first].size();
        double sum = 0;
        std::vector<double> samples(group);
        for (size_t pixel = 0; pixel < pixels; ++pixel) {
            for (size_t i = 0; i < group; ++i) samples[i] = batches.images[first + i][pixel].g;
            sum += estimate_mean(samples).variance;
        }
        variances.push_back(sum / static_cast<double>(pixels));
    }
    return variances;
}

// The lower part of the Cornell box, without its lamp, in pixels so wide that the first hit matters.
Scene view_of_boxes() {
    Scene scene = load_shipped_scene("cornell_box.json");
    scene.camera.target = {0, 0.5f, 0};
    scene.camera.vertical_fov = 20;
    return scene;
}

RenderSettings settings_of(const std::string& chapter, uint32_t splitting_factor) {
    RenderSettings settings{.width = 16, .height = 16, .samples = 1, .max_path_length = 4};
    settings.seed = chapter_seed(chapter) + splitting_factor;
    settings.splitting_factor = splitting_factor;
    settings.estimator = chapter_estimator(chapter);
    return settings;
}

// The line V_out + V_in / s through the measured variances, by weighted least squares.
struct SplittingFit {
    Difference outer;                   // V_out
    double inner;                       // V_in
    double p_value;                     // of the fit, a chi-square
    double smallest_detectable_misfit;  // of any one variance, relative
};
SplittingFit fit_variances(const std::vector<std::vector<double>>& variances_of_factor) {
    double w = 0, wx = 0, wxx = 0, wy = 0, wxy = 0, worst_error = 0;
    std::vector<MeanEstimate> estimates;
    for (size_t i = 0; i < splitting_factors.size(); ++i) {
        estimates.push_back(estimate_mean(variances_of_factor[i]));
        const double x = 1.0 / splitting_factors[i], y = estimates[i].mean,
                     weight = 1 / (estimates[i].standard_error * estimates[i].standard_error);
        w += weight, wx += weight * x, wxx += weight * x * x, wy += weight * y, wxy += weight * x * y;
        worst_error = std::max(worst_error, estimates[i].standard_error / y);
    }
    const double determinant = w * wxx - wx * wx;
    SplittingFit fit{};
    fit.inner = (w * wxy - wx * wy) / determinant;
    const double degrees_of_freedom = static_cast<double>(splitting_factors.size() * (variances_of_factor[0].size() - 1));
    fit.outer = {(wxx * wy - wx * wxy) / determinant, std::sqrt(wxx / determinant), degrees_of_freedom};
    double chi_square = 0;
    for (size_t i = 0; i < splitting_factors.size(); ++i) {
        const double predicted = fit.outer.value + fit.inner / splitting_factors[i];
        // The standard error is itself an estimate: t² would exceed the chi-square bound too often.
        const Difference misfit{estimates[i].mean - predicted, estimates[i].standard_error,
                                static_cast<double>(variances_of_factor[i].size() - 1)};
        chi_square += misfit.z() * misfit.z();
    }
    fit.p_value = chi_square_p_value(chi_square, static_cast<double>(splitting_factors.size() - 2));
    fit.smallest_detectable_misfit = smallest_detectable_bias(worst_error, significance, power);
    return fit;
}

class Splitting : public OnEachChapter {};
INSTANTIATE_TEST_SUITE_P(Chapters, Splitting, testing::ValuesIn(chapters_that(splits_paths)), chapter_name);

TEST_P(Splitting, LowersTheVarianceAfterTheFirstHit) {
    std::vector<std::vector<double>> variances;
    for (const uint32_t s : splitting_factors)
        variances.push_back(sample_variances(render_batches(view_of_boxes(), settings_of(GetParam(), s), 256), 8));
    const SplittingFit fit = fit_variances(variances);
    std::printf("  V_out %.4f, V_in %.4f, p of the fit %.2g; finds a variance that is off by %.1f %%\n", fit.outer.value,
                fit.inner, fit.p_value, 100 * fit.smallest_detectable_misfit);
    EXPECT_GT(fit.p_value, significance);
    EXPECT_LT(fit.smallest_detectable_misfit, 0.2);
    EXPECT_GT(fit.inner, 0);
    EXPECT_GT(fit.outer.value, 5 * fit.outer.standard_error) << "what splitting cannot lower is not there";
}

// All camera rays hit the same point, so only the branches are random: V_out = 0 if they are independent. A correlation r between
// them would show as V_out = r V_in.
TEST_P(Splitting, BranchesAreIndependent) {
    Scene scene = view_of_boxes();
    scene.camera.target = {-0.1f, 0.3f, 0};
    scene.camera.vertical_fov = 1e-3f;
    std::vector<std::vector<double>> variances;
    for (const uint32_t s : splitting_factors)
        variances.push_back(sample_variances(render_batches(scene, settings_of(GetParam(), s), 256), 16));
    const SplittingFit fit = fit_variances(variances);
    EXPECT_GT(fit.p_value, significance);
    expect_no_difference("correlation of branches", std::vector{fit.outer.relative_to(fit.inner)}, 0.1);
}

}  // namespace
}  // namespace lab
