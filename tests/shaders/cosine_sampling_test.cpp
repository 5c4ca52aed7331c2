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

}  // namespace
}  // namespace lab
