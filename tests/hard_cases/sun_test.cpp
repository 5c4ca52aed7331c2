// A light probe with a sun: one texel is 10^6 times as bright as the others.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/lambert_polygon.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

constexpr uint32_t width = 64, height = 32;
constexpr uvec2 ordinary_sun{40, 8};
constexpr float sky_radiance = 0.1f, sun_radiance = 1e5f;

// Each backend has seeds of its own.
uint32_t place_of(Backend backend) {
    return static_cast<uint32_t>(std::ranges::find(all_backends, backend) - std::begin(all_backends));
}

// A white floor under the probe, and lamps of radiance 10^5; the camera sees only the floor.
constexpr float lamp_radiance = 1e5f;
Scene sunny_floor(uvec2 sun = ordinary_sun, float sky = sky_radiance, std::vector<Quad> lamps = {}) {
    std::vector<Material> materials{diffuse_material(vec3(1))};
    if (!lamps.empty()) materials.push_back(diffuse_material(vec3(0), vec3(lamp_radiance)));
    lamps.insert(lamps.begin(), {{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0});
    Scene scene = make_scene(materials, lamps);
    scene.camera = {{0, 2, 0}, {0, 0, 0}, {0, 0, -1}, 30};
    scene.background = vec3(1);
    scene.light_probe = Image{width, height, std::vector<float>(size_t{3} * width * height, sky)};
    for (size_t channel = 0; channel < 3; ++channel)
        scene.light_probe->pixels[3 * (size_t{sun.y} * width + sun.x) + channel] = sun_radiance;
    return scene;
}

// A texel's centre shows its full radiance; in between, radiance is interpolated linearly.
// The probe wraps around from side to side, and ends at the poles.
double radiance(double column, double row, uvec2 sun, double sky) {
    const double away = std::abs(column - sun.x), near_x = std::max(0.0, 1 - std::min(away, width - away)),
                 near_y = std::max(0.0, 1 - std::abs(std::max(row, 0.0) - sun.y));
    return sky + (double{sun_radiance} - sky) * near_x * near_y;
}

// The radiance of the floor: ∫ L cos θ / π over the upper hemisphere, by the midpoint rule.
double floor_radiance(uvec2 sun = ordinary_sun, double sky = sky_radiance) {
    constexpr int steps = 64;  // per texel
    double sum = 0;
    for (int i = 0; i < static_cast<int>(height) / 2 * steps; ++i)
        for (int j = 0; j < static_cast<int>(width) * steps; ++j) {
            const double row = (i + 0.5) / steps, column = (j + 0.5) / steps, theta = pi * row / height;
            sum += radiance(column - 0.5, row - 0.5, sun, sky) * std::cos(theta) * std::sin(theta);
        }
    return sum / pi * (pi / height) * (2 * pi / width) / (steps * steps);
}

class SunCases : public OnEachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, SunCases, testing::ValuesIn(all_backends), own_backend_name);

TEST_P(SunCases, IsSeenAtItsFullRadiance) {
    Scene scene = sunny_floor();
    const uvec2 sun = ordinary_sun;
    const double azimuth = 2 * pi * (sun.x + 0.5 - width / 2.0) / width, inclination = pi * (sun.y + 0.5) / height;
    scene.camera = {.position = {0, 1, 0},
                    .target = vec3(0, 1, 0) + vec3(dvec3(std::sin(inclination) * std::sin(azimuth), std::cos(inclination),
                                                         -std::sin(inclination) * std::cos(azimuth))),
                    .up = {0, 1, 0},
                    .vertical_fov = 1e-3f};
    const FilmImage film = render(scene, {.width = 1, .height = 1, .samples = 1, .backend = GetParam()});
    EXPECT_NEAR(radiance_at(film, 0, 0).r / sun_radiance, 1, 1e-3);
}

// Light samples find the sun wherever it is, with and without bounces.
TEST_P(SunCases, IsFoundByLightSamplesWhereverItIs) {
    const struct {
        const char* name;
        uvec2 sun;
        float sky;
        float rotation = 0;  // about the floor's normal: its illumination stays the same
    } cases[] = {{"ordinary", ordinary_sun, sky_radiance},
                 {"at the pole", {40, 0}, sky_radiance},
                 {"across the seam", {0, 8}, sky_radiance},
                 {"across the other side of the seam", {width - 1, 12}, sky_radiance},
                 {"at the horizon", {20, height / 2 - 1}, sky_radiance},
                 {"in a black sky", {13, 5}, 0},
                 {"in a black sky that is turned", {13, 5}, 0, 2.5f}};
    uint32_t seed = 100 * (1 + place_of(GetParam()));
    for (const auto& [name, sun, sky, rotation] : cases)
        for (const bool only_light_samples : {false, true}) {
            const bool is_first = sun == ordinary_sun && !only_light_samples;
            RenderSettings settings{
                .samples = is_first ? 2048u : 128u, .max_path_length = 1, .seed = ++seed, .backend = GetParam()};
            settings.estimator = chapter_estimator(chapter_named("light_probes"));
            if (only_light_samples) settings.estimator.defines = {"STRATEGY STRATEGY_LIGHT"};
            Scene scene = sunny_floor(sun, sky);
            scene.probe_rotation = rotation;
            const MeanEstimate mean = estimate_mean(pixel_means(render(scene, settings), 1));
            const double expected = floor_radiance(sun, sky);
            if (is_first) record("mean_over_integral", "%.4f ± %.4f", mean.mean / expected, mean.standard_error / expected);
            expect_mean(name + std::string(only_light_samples ? ", light samples alone" : ""), mean, expected,
                        is_first ? 0.003 : 0.018, 2 * std::size(cases));
        }
}

TEST_P(SunCases, LampAndSunAddUp) {
    RenderSettings settings{.samples = 64, .max_path_length = 1, .seed = 77 + place_of(GetParam()), .backend = GetParam()};
    settings.estimator = chapter_estimator(chapter_named("light_probes"));
    // A lamp so far to the side that it hides almost nothing of the sky, and not the sun.
    const std::vector<dvec3> lamp{{9, 5, -9}, {10, 5, -8}, {10, 6, -8}, {9, 6, -9}};
    Scene scene = sunny_floor(ordinary_sun, sky_radiance, {{vec3(lamp[0]), vec3(lamp[1] - lamp[0]), vec3(lamp[3] - lamp[0]), 1}});
    scene.camera.vertical_fov = 0.5f;
    const double of_lamp = double{lamp_radiance} * polygon_irradiance(lamp, dvec3(0), {0, 1, 0}) / pi;
    const double of_sun = floor_radiance();
    ASSERT_GT(of_lamp, 0.1 * of_sun);
    expect_mean("lamp and sun", estimate_mean(pixel_means(render(scene, settings), 1)), of_lamp + of_sun, 0.02);
}

// A dim sky, found by light samples alone, next to a sun below the horizon that attracts nearly all of them. In a probe of this
// size the alias table has 2^23 entries, and nearly all of them keep one sample in thousands.
TEST(Sun, LeavesADimSkyItsShareOfTheLargestTable_all) {
    Scene scene = sunny_floor();
    const uint32_t columns = MAX_PROBE_CELL_COLUMNS, rows = MAX_PROBE_CELL_ROWS;
    scene.light_probe = Image{columns, rows, std::vector<float>(size_t{3} * columns * rows, 1.0f)};
    const size_t sun = 3 * (size_t{1500} * columns + 1000);
    std::fill_n(scene.light_probe->pixels.begin() + static_cast<ptrdiff_t>(sun), 3, 1e10f);
    for (const std::string& chapter : {chapter_named("light_probes"), chapter_named("low_discrepancy_points")}) {
        RenderSettings settings{.samples = 1024, .max_path_length = 1, .seed = 31};
        settings.estimator = chapter_estimator(chapter);
        settings.estimator.defines.push_back("STRATEGY STRATEGY_LIGHT");
        expect_mean(chapter, estimate_mean(pixel_means(render(scene, settings), 1)), 1, 0.25, 2);
    }
}

TEST_P(SunCases, BlackProbesGiveNothing) {
    RenderSettings settings{.samples = 16, .max_path_length = 4, .backend = GetParam()};
    settings.estimator = chapter_estimator(chapter_named("light_probes"));
    Scene scene = sunny_floor();
    scene.light_probe->pixels.assign(scene.light_probe->pixels.size(), 0.0f);
    for (const FilmPixel& pixel : render(scene, settings).pixels) ASSERT_EQ(pixel.sum, vec3(0));
}

}  // namespace
}  // namespace lab
