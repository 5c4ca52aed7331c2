// A light probe with a sun: one texel 10^6 times as bright as the others.
#include <cmath>
#include <numbers>

#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

constexpr uint32_t width = 64, height = 32;
constexpr uvec2 sun{40, 8};
constexpr float sky_radiance = 0.1f, sun_radiance = 1e5f;

// A white floor under the probe; the camera sees nothing but the floor.
Scene sunny_floor() {
    Scene scene = make_scene({diffuse_material(vec3(1))}, {{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}}});
    scene.camera = {{0, 2, 0}, {0, 0, 0}, {0, 0, -1}, 30};
    scene.background = vec3(1);
    scene.light_probe = Image{width, height, std::vector<float>(size_t{3} * width * height, sky_radiance)};
    for (size_t channel = 0; channel < 3; ++channel)
        scene.light_probe->pixels[3 * (size_t{sun.y} * width + sun.x) + channel] = sun_radiance;
    return scene;
}

// Texel centres have the full radiance of a texel; between them it changes linearly.
double radiance(double column, double row) {
    const double near_x = std::max(0.0, 1 - std::abs(column - sun.x)),
                 near_y = std::max(0.0, 1 - std::abs(row - sun.y));
    return sky_radiance + double{sun_radiance - sky_radiance} * near_x * near_y;
}

// The radiance of the floor: ∫ L cos θ / π over the upper hemisphere, by the midpoint rule.
double floor_radiance() {
    constexpr int steps = 64;  // a texel
    double sum = 0;
    for (int i = 0; i < static_cast<int>(height) / 2 * steps; ++i)
        for (int j = 0; j < static_cast<int>(width) * steps; ++j) {
            const double row = (i + 0.5) / steps, column = (j + 0.5) / steps, theta = pi * row / height;
            sum += radiance(column - 0.5, row - 0.5) * std::cos(theta) * std::sin(theta);
        }
    return sum / pi * (pi / height) * (2 * pi / width) / (steps * steps);
}

class SunCases : public OnEachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, SunCases, testing::ValuesIn(all_backends), backend_name);

TEST_P(SunCases, LightsAFloorAsItsIntegralSays) {
    const uint32_t samples = runs_all_tests() ? 16384 : 512;
    RenderSettings settings{.samples = samples,
                            .max_path_length = 1,
                            .seed = 21 + static_cast<uint32_t>(GetParam()),
                            .backend = GetParam()};
    settings.estimator = chapter_estimator("02_cosine_sampling");
    const double expected = floor_radiance();
    const MeanEstimate mean = estimate_mean(pixel_means(render(sunny_floor(), settings), 1));
    record("mean_over_integral", "%.3f ± %.3f", mean.mean / expected, mean.standard_error / expected);
    expect_mean("radiance of the floor over its integral", mean, expected, 0.12 * std::sqrt(512.0 / samples));
}

TEST_P(SunCases, IsSeenAtItsFullRadiance) {
    Scene scene = sunny_floor();
    const double azimuth = 2 * pi * (sun.x + 0.5 - width / 2.0) / width,
                 inclination = pi * (sun.y + 0.5) / height;
    scene.camera = {
        .position = {0, 1, 0},
        .target = vec3(0, 1, 0) + vec3(dvec3(std::sin(inclination) * std::sin(azimuth), std::cos(inclination),
                                             -std::sin(inclination) * std::cos(azimuth))),
        .up = {0, 1, 0},
        .vertical_fov = 1e-3f};
    const FilmImage film = render(scene, {.width = 1, .height = 1, .samples = 1, .backend = GetParam()});
    EXPECT_NEAR(radiance_at(film, 0, 0).r / sun_radiance, 1, 1e-3);
}

}  // namespace
}  // namespace lab
