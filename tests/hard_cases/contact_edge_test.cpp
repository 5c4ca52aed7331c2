// A light that touches what it illuminates. A point y on it, uniform by area, has the weight A cos θ cos θ' / r², and near the
// contact edge r goes to 0: at distance h from the edge the standard deviation grows as 1/h, and a pixel that contains the edge
// has infinite variance. Its samples exceed t with a probability of about t^(-3/2), so by the theory of stable laws the error of
// their mean falls only as N^(-1/3), although the mean is right. From chapter 7 on the weights are bounded, which cures this.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "hard_cases/probe.h"
#include "support/error_slope.h"
#include "support/expect_statistics.h"
#include "support/lambert_polygon.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

// A floor [0,1]² and a wall of light above its edge x = 0. The camera looks straight down on the floor: pixels of a row, as wide
// as the image is high, span the distances from `nearest` to `farthest` from the edge.
Scene floor_and_wall(double nearest, double farthest) {
    Scene scene = make_scene({diffuse_material(vec3(1)), diffuse_material(vec3(0), vec3(1))},
                             {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0}, {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1}});
    const double height = 0.5;
    const auto middle = static_cast<float>(0.5 * (nearest + farthest));
    scene.camera = {.position = {middle, 0.5f, static_cast<float>(height)}, .target = {middle, 0.5f, 0}, .up = {1, 0, 0}};
    scene.camera.vertical_fov = static_cast<float>(2 * std::atan(0.5 * (farthest - nearest) / height) * 180 / pi);
    return scene;
}

const std::string next_event_estimation = chapter_named("next_event_estimation"),
                  multiple_importance_sampling = chapter_named("multiple_importance_sampling");

RenderSettings settings(const std::string& chapter) {
    RenderSettings settings{.max_path_length = 1};
    settings.estimator = chapter_estimator(chapter);
    return settings;
}

struct Row {
    double distance;  // from the edge
    uint32_t samples;
    double largest_bias;
};

// The largest ratio of a sample's standard deviation to its mean.
double expect_lambert(const std::string& chapter, const std::vector<Row>& rows) {
    double largest_ratio = 0;
    for (const auto& [h, samples, limit] : rows) {
        RenderSettings row = settings(chapter);
        row.samples = samples;
        const auto means = pixel_means(render(floor_and_wall(0.999 * h, 1.001 * h), row), 0);
        const std::vector<dvec3> wall{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};
        const double expected = polygon_irradiance(wall, {h, 0.5, 0}, {0, 0, 1}) / pi;
        const MeanEstimate radiance = estimate_mean(means);
        const double ratio = std::sqrt(radiance.variance * samples) / radiance.mean;
        char name[48], text[16];
        std::snprintf(name, sizeof name, "sd_over_mean_at_%g", h);
        std::snprintf(text, sizeof text, "%.1f", ratio);
        testing::Test::RecordProperty(name, text);
        expect_mean(name + std::string(" ") + text, radiance, expected, limit, rows.size());
        largest_ratio = std::max(largest_ratio, ratio);
    }
    return largest_ratio;
}

TEST(ContactEdge, IsLitAsLambertSaysWhereTheVarianceIsFinite) {
    expect_lambert(next_event_estimation, {{0.1, 16, 0.1}, {0.03, 64, 0.2}, {0.01, 256, 0.3}});
}

TEST(ContactEdge, IsNotNoisyWithMultipleImportanceSampling) {
    EXPECT_LT(
        expect_lambert(multiple_importance_sampling, {{0.1, 32, 0.03}, {0.03, 32, 0.03}, {0.01, 32, 0.03}, {1e-4, 32, 0.03}}), 2);
}

// Each pixel shows the whole view: 3136 independent estimates of its mean.
RenderSettings view_in_each_pixel(const std::string& chapter) {
    RenderSettings image = settings(chapter);
    image.width = image.height = 56;
    image.estimator = {.file = probe("view_in_each_pixel").file, .observed = image.estimator.file};
    return image;
}

TEST(ContactEdge, IsFlaggedByTheSlopeOfTheError_all) {
    const RenderSettings image = view_in_each_pixel(next_event_estimation);
    for (const bool has_edge : {true, false}) {
        const ErrorSlope slope = measure_error_slope(has_edge ? floor_and_wall(0, 1) : floor_and_wall(0.2, 1), image, 1024);
        std::printf("  slope %.3f +- %.3f, variance of a sample, from 1, 4, 16 ... samples:%s\n", slope.value,
                    slope.standard_error, slope.variances.c_str());
        RecordProperty(has_edge ? "slope_with_the_edge" : "slope_without", std::to_string(slope.value));
        const bool is_flagged = std::abs(slope.value + 0.5) > slope_tolerance;
        EXPECT_EQ(is_flagged, has_edge) << slope.value;
        if (!has_edge) {
            EXPECT_LT(slope.standard_error, largest_slope_error) << "the test is too weak, take larger images";
        }
    }
}

}  // namespace
}  // namespace lab
