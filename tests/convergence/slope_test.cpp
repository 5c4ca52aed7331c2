// The error falls with the square root of the number of samples. A slower fall tells of samples that depend
// on each other, of seeds that repeat or of an infinite variance.
#include <cstdio>

#include "support/error_slope.h"
#include "support/expect_statistics.h"

namespace lab {
namespace {

// That the error of a chapter falls with the root of the number of samples, and that a slope which is off by
// 0.07 would have been found.
void expect_slope(const Scene& scene, const std::string& chapter, RenderSettings settings) {
    settings.splitting_factor = 2;
    settings.roulette_start = 2;
    settings.estimator = chapter_estimator(chapter);
    settings.seed = 1000 * chapter_number(chapter);
    const ErrorSlope slope = measure_error_slope(scene, settings, 1024);
    // A slope that leaves the tolerance with this probability.
    const double finds = slope_tolerance + normal_quantile(power) * slope.standard_error;
    std::printf("  variance of a sample, from 1, 4, 16 ... samples:%s\n  slope %.4f; finds one off by %.3f\n",
                slope.variances.c_str(), slope.value, finds);
    EXPECT_NEAR(slope.value, -0.5, slope_tolerance);
    EXPECT_LT(slope.standard_error, largest_slope_error) << "the test is too weak, take larger images";
}

class Convergence : public OnEachChapter {};
INSTANTIATE_TEST_SUITE_P(Chapters, Convergence, testing::ValuesIn(all_chapters), chapter_name);

TEST_P(Convergence, ErrorFallsWithTheRootOfTheNumberOfSamples) {
    Scene scene = load_shipped_scene("cornell_box.json");
    // Without the lamp: a few pixels at its edge would decide the error of the whole image.
    scene.camera.target = {0, 0.7f, 0};
    scene.camera.vertical_fov = 22;
    expect_slope(scene, GetParam(), {.width = 56, .height = 56, .max_path_length = 3});
}

TEST_P(Convergence, ErrorUnderASkyFallsWithTheRootOfTheNumberOfSamples) {
    expect_slope(load_shipped_scene("textured.json"), GetParam(),
                 {.width = 48, .height = 48, .max_path_length = 2});
}

}  // namespace
}  // namespace lab
