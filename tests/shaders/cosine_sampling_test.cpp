// Chapter 2's sampling of directions with density cos θ / π per solid angle, and its copy for the later
// chapters.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "support/bounce.h"
#include "support/device_arithmetic.h"
#include "support/directions.h"
#include "support/expect_statistics.h"
#include "support/hemisphere.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

const std::vector<std::string> chapters = chapters_from(2);
const std::string& chapter_2 = chapters.front();

std::vector<Bounce> sample(const std::string& chapter, const dvec3& normal, size_t count, uint32_t run) {
    return sample_bounces(chapter, {vec3(normal), vec3(normal), white_material()}, count, run);
}

// The corners of the unit square, what is next to them, and a grid.
constexpr float below_one = 1 - 0x1p-24f;
std::vector<HemisphereQuery> grid_and_corners() {
    std::vector<HemisphereQuery> queries;
    for (const float x : {0.0f, 0x1p-24f, 0.25f, 0.5f, 0.75f, below_one})
        for (const float y : {0.0f, 0x1p-24f, 0x1p-12f, 0.5f, 1 - 0x1p-12f, below_one})
            queries.push_back({{x, y}, vec3(0)});
    for (int x = 0; x < 512; ++x)
        for (int y = 0; y < 512; ++y)
            queries.push_back(
                {{(static_cast<float>(x) + 0.5f) / 512, (static_cast<float>(y) + 0.5f) / 512}, vec3(0)});
    return queries;
}

TEST(CosineSampling, FollowsItsDensity) {
    // The probability of cos θ < c is c²: exact.
    const auto integral = [](double c) { return c * c; };
    uint32_t run = 50;
    for (const dvec3& normal : test_normals()) {
        const auto bounces = sample(chapter_2, normal, 4'000'000, ++run);
        for (const auto& [rows, columns] : {std::pair{16u, 32u}, {51u, 102u}})
            expect_distribution("normal " + std::to_string(run - 50) + ", " + std::to_string(rows) + " x " +
                                    std::to_string(columns) + " cells",
                                histogram(bounces, Frame(normal), rows, columns),
                                cell_probabilities(rows, columns, integral), 0.015);
    }
}

TEST(CosineSampling, HasTheCellProbabilitiesOfTheDensityFunction) {
    // get_hemisphere_density() integrated over the histogram's cells (midpoint rule: it is linear in cos θ)
    // equals the exact probabilities, so sampler and density cannot be wrong together. Below the horizon it
    // is 0.
    constexpr size_t rows = 51, columns = 8;
    std::vector<HemisphereQuery> queries;
    for (const double side : {1.0, -1.0})
        for (size_t row = 0; row < rows; ++row)
            for (size_t column = 0; column < columns; ++column) {
                const double c = (static_cast<double>(row) + 0.5) / rows, s = std::sqrt(1 - c * c),
                             phi = 2 * pi * (static_cast<double>(column) + 0.5) / columns;
                queries.push_back({vec2(0), vec3(dvec3(std::cos(phi) * s, std::sin(phi) * s, side * c))});
            }
    const auto answers = evaluate_hemisphere(chapter_2, queries);
    const auto exact = cell_probabilities(rows, columns, [](double c) { return c * c; });
    const double solid_angle = 2 * pi / (rows * columns);
    double sum = 0;
    for (size_t i = 0; i < exact.size(); ++i) {
        EXPECT_NEAR(answers[i].density * solid_angle / exact[i], 1, 1e-6);
        EXPECT_EQ(answers[exact.size() + i].density, 0);
        sum += answers[i].density * solid_angle;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
}

TEST(CosineSampling, MapsNumbersToUnitDirectionsAboveTheHorizon) {
    const auto queries = grid_and_corners();
    const auto answers = evaluate_hemisphere(chapter_2, queries);
    double worst = 0, worst_length = 0, lowest = 1;
    for (size_t i = 0; i < queries.size(); ++i) {
        const double phi = 2 * pi * queries[i].numbers.x - pi, y = queries[i].numbers.y;
        const dvec3 found(answers[i].direction),
            expected(std::cos(phi) * std::sqrt(y), std::sin(phi) * std::sqrt(y), std::sqrt(1 - y));
        worst = std::max(worst, glm::length(found - expected));
        worst_length = std::max(worst_length, std::abs(glm::length(found) - 1));
        lowest = std::min(lowest, found.z);
    }
    std::printf("  largest error of a direction %.2g, of its length %.2g; lowest %.3g\n", worst, worst_length,
                lowest);
    record("largest_error_of_a_direction", "%.1e", worst);
    EXPECT_GT(lowest, 0);
    EXPECT_LT(worst, 2 * test_arithmetic().sine + 1e-6);
    EXPECT_LT(worst_length, 2 * test_arithmetic().sine + 2 * test_arithmetic().division);
}

TEST(CosineSampling, IsTheSameInLaterChapters) {
    const auto queries = grid_and_corners();
    const auto expected = evaluate_hemisphere(chapter_2, queries);
    for (const std::string& chapter : chapters) {
        const auto answers = evaluate_hemisphere(chapter, queries);
        for (size_t i = 0; i < queries.size(); ++i)
            ASSERT_EQ(answers[i].direction, expected[i].direction) << chapter;
    }
}

TEST(CosineSampling, HasTheDensityOfTheJacobian) {
    // |det J| of the map from random numbers to directions is the solid angle per unit area, 1 / density. In
    // the coordinates φ and cos² θ the map is linear, so differences of any size give the derivatives, up to
    // the corners: dω = dφ d(cos² θ) / (2 cos θ).
    const float steps[] = {0, 0x1p-24f, 0x1p-10f, 0.25f, 0.5f, 0.75f, 1 - 0x1p-10f, below_one};
    std::vector<HemisphereQuery> queries;
    for (const float x : steps)
        for (const float y : steps)
            for (const vec2 shift : {vec2(0), vec2(0.125f, 0), vec2(0, 0.125f)}) {
                const vec2 corner(x, y), sign(x < 0.5f ? 1 : -1, y < 0.5f ? 1 : -1);
                queries.push_back({corner + sign * shift, vec3(0)});
            }
    auto answers = evaluate_hemisphere(chapter_2, queries);
    for (size_t i = 0; i < queries.size(); ++i) queries[i].direction = answers[i].direction;
    answers = evaluate_hemisphere(chapter_2, queries);
    double worst = 0;
    for (size_t i = 0; i < queries.size(); i += 3) {
        const auto phi = [&](size_t k) {
            // At the pole any azimuth will do.
            const dvec3 d(queries[i + k].direction);
            return d.x == 0 && d.y == 0 ? 2 * pi * queries[i + k].numbers.x - pi : std::atan2(d.y, d.x);
        };
        const auto square = [&](size_t k) { return std::pow(double{queries[i + k].direction.z}, 2); };
        const double d_phi = std::remainder(phi(1) - phi(0), 2 * pi), d_square = square(2) - square(0);
        const double solid_angle =
            std::abs(d_phi * d_square) / (2 * queries[i].direction.z) / (0.125 * 0.125);
        worst = std::max(worst, std::abs(solid_angle * answers[i].density - 1));
    }
    std::printf("  largest relative difference of Jacobian and density %.2g\n", worst);
    EXPECT_LT(worst, 1e-5 + 20 * test_arithmetic().sine);
}

TEST(CosineSampling, WeightsEveryDirectionWithTheAlbedo) {
    // So a Lambertian surface under a uniform sky has no variance.
    Material material = white_material();
    material.diffuse_albedo = vec3(0.7f);
    const dvec3 normal = test_normals()[2];
    for (const std::string& chapter : chapters) {
        size_t dropped = 0;
        const auto bounces = sample_bounces(chapter, {vec3(normal), vec3(normal), material}, 1'000'000, 60);
        for (const Bounce& bounce : bounces) {
            ASSERT_EQ(bounce.weight, bounce.ray_count == 2 ? 0.7f : 0.0f) << chapter;
            dropped += bounce.ray_count != 2;
        }
        EXPECT_LE(dropped, 10u) << chapter;
    }
}

TEST(CosineSampling, PredictsTheVarianceOfOtherSamplers) {
    // A white surface under a white sky shows 1. With directions of density p one sample has the second
    // moment ∫ (cos θ / π)² / p dω, which is the mean of (cos θ / π) / p over directions of density cos θ /
    // π.
    std::vector<double> hemisphere, sphere, angles;
    uint32_t run = 70;
    for (const dvec3& normal : test_normals()) {
        const Frame frame(normal);
        for (const Bounce& bounce : sample(chapter_2, normal, 2'000'000, ++run)) {
            const auto [cos_theta, sin_theta, phi] = frame.angles(bounce.direction);
            hemisphere.push_back(2 * cos_theta - 1);
            sphere.push_back(4 * cos_theta - 1);
            angles.push_back(pi * cos_theta * sin_theta - 1);
        }
    }
    expect_mean("variance of uniform directions on the hemisphere, 1/3", estimate_mean(hemisphere), 1.0 / 3,
                0.005);
    expect_mean("variance of uniform directions on the sphere, 5/3", estimate_mean(sphere), 5.0 / 3, 0.005);
    expect_mean("variance of uniform angles, π²/8 - 1", estimate_mean(angles), pi * pi / 8 - 1, 0.005);
}

}  // namespace
}  // namespace lab
