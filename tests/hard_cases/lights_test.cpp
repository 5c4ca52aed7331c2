// Lights of extreme sizes, distances and powers: next event estimation against Lambert's formula.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "hard_cases/probe.h"
#include "support/expect_statistics.h"
#include "support/lambert_polygon.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

constexpr float albedo = 0.8f;

class Lights : public OnEachBackend {
  protected:
    static std::vector<std::string> chapters() { return chapters_for(GetParam(), chapters_that(samples_lights)); }
    RenderSettings settings(const std::string& chapter, uint32_t samples, uint32_t seed) const {
        RenderSettings settings{
            .width = 16, .height = 16, .samples = samples, .max_path_length = 1, .seed = chapter_seed(chapter) + seed};
        settings.estimator = chapter_estimator(chapter);
        settings.backend = GetParam();
        return settings;
    }
};
INSTANTIATE_TEST_SUITE_P(Backends, Lights, testing::ValuesIn(all_backends), own_backend_name);

// A floor [-1,1]² in the plane z = 0, of which the camera sees little more than the origin. It has material 0.
Scene floor_with(const std::vector<vec3>& emissions, std::vector<Quad> lights) {
    std::vector<Material> materials{diffuse_material(vec3(albedo))};
    for (const vec3& emission : emissions) materials.push_back(diffuse_material(vec3(0), emission));
    lights.insert(lights.begin(), {{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0});
    Scene scene = make_scene(materials, lights);
    scene.camera = {.position = {-0.1f, -0.6f, 0.4f}, .target = {0, 0, 0}, .up = {0, 0, 1}, .vertical_fov = 0.05f};
    return scene;
}

// Radiance of the floor at the origin, from fully visible lights.
double expected_radiance(const Scene& scene) {
    double sum = 0;
    for (size_t i = 2; i < scene.triangles.size(); ++i) {
        std::vector<dvec3> corners;
        for (int k = 0; k < 3; ++k) corners.emplace_back(scene.positions[scene.triangles[i][k]]);
        const double emission = scene.materials[scene.triangle_materials[i]].emission.r;
        sum += emission * polygon_irradiance(corners, dvec3(0), {0, 0, 1});
    }
    return albedo * sum / pi;
}

struct LightCase {
    const char* name;
    Quad quad;
    float emission;
};

TEST_P(Lights, OfExtremeSizesAndDistancesIlluminateAsLambertSays) {
    const LightCase cases[] = {
        {"ordinary", {{0.3f, 0.2f, 0.8f}, {0, 0.5f, 0}, {0.5f, 0, 0}, 1}, 1},
        {"1e-6_wide", {{0.3f, 0.2f, 0.8f}, {0, 1e-6f, 0}, {1e-6f, 0, 0}, 1}, 1e12f},
        {"1e-6_narrow", {{0.3f, 0.2f, 0.8f}, {0, 1e-6f, 0}, {1, 0, 0}, 1}, 1e6f},
        {"1e6_away", {{3e5f, 2e5f, 1e6f}, {0, 1e5f, 0}, {1e5f, 0, 0}, 1}, 100},
        {"small_1e6_away", {{3e5f, 2e5f, 1e6f}, {0, 1, 0}, {1, 0, 0}, 1}, 1e12f},
    };
    for (const auto& [name, quad, emission] : cases) {
        const Scene scene = floor_with({vec3(emission)}, {quad});
        const double expected = expected_radiance(scene);
        uint32_t seed = 0;
        for (const std::string& chapter : chapters()) {
            const MeanEstimate radiance = estimate_mean(pixel_means(render(scene, settings(chapter, 16, ++seed)), 0));
            expect_mean(std::string(name) + ", " + chapter, radiance, expected, 0.1,
                        std::size(cases) * chapters_that(samples_lights).size());
            RecordProperty(std::string("error_of_light_") + name, percent(radiance.mean / expected - 1));
        }
    }
}

// Near 90 degrees a cosine is a difference of nearly equal numbers: its error is that of the positions relative to the distance.
TEST_P(Lights, AtGrazingAnglesErrByTheRoundingOfPositions) {
    for (const double degrees : {89.0, 89.9, 89.99, 89.999, 89.9999}) {
        const double cosine = std::cos(degrees * pi / 180), sine = std::sin(degrees * pi / 180);
        // Light that arrives just above the horizon, and a light above the floor whose plane just misses the origin.
        const dvec3 to_light(0, 0.6, 0.8), across(0, -0.8, 0.6);
        const auto height = static_cast<float>(cosine);
        const Quad low{{1, 0, height}, {0, 0.01f, 0}, {0, 0, 0.01f * height}, 1};
        const Quad on_edge{vec3(to_light), {0.5f, 0, 0}, 0.5f * vec3(sine * to_light + cosine * across), 1};
        for (auto [name, quad] : {std::pair("low", low), std::pair("seen_from_its_edge", on_edge)}) {
            if (expected_radiance(floor_with({vec3(1)}, {quad})) == 0) std::swap(quad.edge_u, quad.edge_v);
            Scene scene = floor_with({vec3(1)}, {quad});
            scene.camera.vertical_fov = 1e-5f;  // elsewhere on the floor the angle differs
            const double expected = expected_radiance(scene);
            const MeanEstimate radiance = estimate_mean(pixel_means(render(scene, settings(chapters().front(), 64, 1)), 0));
            const double error = radiance.mean / expected - 1, noise = radiance.standard_error / expected;
            std::printf("  %s, %g degrees: off by %s +- %s\n", name, degrees, percent(error).c_str(), percent(noise).c_str());
            EXPECT_LT(noise, 0.01);
            EXPECT_LT(std::abs(error), 2 * 0x1p-24 / cosine + 6 * noise) << name << ", " << degrees;
            if (degrees == 89.9999) RecordProperty(std::string("error_of_light_") + name, percent(error));
        }
    }
}

TEST_P(Lights, ScaleThePictureByTheirEmission) {
    const Quad quad{{0.3f, 0.2f, 0.8f}, {0, 0.5f, 0}, {0.5f, 0, 0}, 1};
    for (const std::string& chapter : chapters()) {
        const FilmImage expected = render(floor_with({vec3(1)}, {quad}), settings(chapter, 4, 1));
        for (const int exponent : {-40, 40}) {  // about 10^-12 and 10^12
            const float emission = std::ldexp(1.0f, exponent);
            const FilmImage film = render(floor_with({vec3(emission)}, {quad}), settings(chapter, 4, 1));
            for (size_t i = 0; i < film.pixels.size(); ++i)
                ASSERT_EQ(film.pixels[i].sum, emission * expected.pixels[i].sum) << chapter;
        }
    }
}

TEST_P(Lights, InThePlaneOfTheReceiverGiveNothing) {
    Scene scene = floor_with({vec3(1)}, {{{1, -1, 0}, {1, 0, 0}, {0, 2, 0}, 1}});
    for (const std::string& chapter : chapters())
        for (const FilmPixel& pixel : render(scene, settings(chapter, 16, 1)).pixels) ASSERT_EQ(pixel.sum, vec3(0));
    // Once rotated, its corners are no longer exactly coplanar.
    const mat3 turn(glm::normalize(vec3(2, 1, 0.5f)), glm::normalize(vec3(-1, 2, 0)),
                    glm::normalize(glm::cross(vec3(2, 1, 0.5f), vec3(-1, 2, 0))));
    for (vec3& position : scene.positions) position = turn * position;
    scene.camera.position = turn * scene.camera.position;
    for (const std::string& chapter : chapters())
        for (const FilmPixel& pixel : render(scene, settings(chapter, 16, 1)).pixels) ASSERT_LT(pixel.sum.r, 1e-10f);
}

TEST_P(Lights, ThatAreConvexDoNotLightThemselves) {
    const vec3 emission(1, 2, 0.5f);
    for (const std::string& chapter : chapters()) {
        RenderSettings all = settings(chapter, 16, 1);
        all.max_path_length = 8;
        const Scene scene = make_sphere(diffuse_material(vec3(0.5f), emission), Facing::outwards);
        for (const FilmPixel& pixel : render(scene, all).pixels) ASSERT_EQ(pixel.sum, 16.0f * emission);
    }
}

// One of 100,000 triangles has nearly all the power.
TEST_P(Lights, OfUnequalPowerAreChosenByIt_all) {
    constexpr uint32_t columns = 250, rows = 200;
    std::vector<Quad> quads;
    const float step = 1.0f / columns;
    for (uint32_t y = 0; y < rows; ++y)
        for (uint32_t x = 0; x < columns; ++x)
            quads.push_back({step * vec3(x, y, 0) + vec3(0, 0, 0.8f), {0, step, 0}, {step, 0, 0}, 1});
    Scene scene = floor_with({vec3(1e-12f), vec3(1e6f)}, quads);
    scene.triangle_materials[77'777] = 2;
    ASSERT_EQ(scene.triangles.size(), 100'002);
    EXPECT_NEAR(light_probability_sum(scene), 1, 1e-6);
    const double expected = expected_radiance(scene);
    for (const std::string& chapter : chapters())
        expect_mean(chapter, estimate_mean(pixel_means(render(scene, settings(chapter, 16, 1)), 0)), expected, 0.05,
                    chapters_that(samples_lights).size());
}

// A light that fills the whole lobe, reflected in the floor: k_s cos θ of its radiance. Light samples hardly ever hit a lobe one
// ten-thousandth of a radian wide, so bounces have to find the light with the full weight.
TEST_P(Lights, AreMirroredByTheNarrowestLobes) {
    for (const float exponent : {1e4f, 1e6f, 1e8f})
        for (const std::string& chapter : chapters_for(GetParam(), chapters_that(weights_lights))) {
            const vec3 mirrored = glm::normalize(vec3(0.1f, 0.6f, 0.4f)),
                       across = glm::normalize(glm::cross(mirrored, vec3(1, 0, 0))), along = glm::cross(across, mirrored);
            const Quad light{2.0f * mirrored - 0.3f * (across + along), 0.6f * across, 0.6f * along, 1};
            Scene scene = floor_with({vec3(3)}, {light});
            scene.materials[0].diffuse_albedo = vec3(0);
            scene.materials[0].specular_albedo = vec3(albedo);
            scene.materials[0].specular_exponent = exponent;
            char name[80];
            std::snprintf(name, sizeof name, "exponent %g, %s", double{exponent}, chapter.c_str());
            RenderSettings without_roulette = settings(chapter, 256, 9);
            without_roulette.roulette_start = no_roulette;
            expect_mean(name, estimate_mean(pixel_means(render(scene, without_roulette), 0)), 3.0 * albedo * mirrored.z, 0.01, 6);
        }
}

}  // namespace
}  // namespace lab
