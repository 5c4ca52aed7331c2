// Cosine sampling: density cos θ / π with respect to solid angle.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "support/bounce.h"
#include "support/device_arithmetic.h"
#include "support/directions.h"
#include "support/expect_statistics.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

const std::vector<std::string> chapters = chapters_that(weighs_by_albedo);
const std::string cosine_sampling = chapter_named("cosine_sampling");

std::vector<Bounce> sample(const std::string& chapter, const dvec3& normal, size_t count, uint32_t run) {
    return sample_bounces(chapter, {vec3(normal), vec3(normal), white_material()}, count, run);
}

TEST(CosineSampling, FollowsItsDensity) {
    // The probability of cos θ < c is exactly c².
    const auto integral = [](double c) { return c * c; };
    uint32_t run = 50;
    for (const dvec3& normal : test_normals()) {
        const auto bounces = sample(cosine_sampling, normal, 4'000'000, ++run);
        for (const auto& [rows, columns] : {std::pair{16u, 32u}, {51u, 102u}})
            expect_distribution(
                "normal " + std::to_string(run - 50) + ", " + std::to_string(rows) + " x " + std::to_string(columns) + " cells",
                histogram(bounces, Frame(normal), rows, columns), cell_probabilities(rows, columns, integral), 0.015);
    }
}

TEST(CosineSampling, WeightsEveryDirectionWithTheAlbedo) {
    // So a Lambertian surface under a uniform sky has zero variance.
    Material material = white_material();
    material.diffuse_albedo = vec3(0.7f);
    const dvec3 normal = test_normals()[2];
    for (const std::string& chapter : chapters) {
        size_t dropped = 0;
        const auto bounces = sample_bounces(chapter, {vec3(normal), vec3(normal), material}, 1'000'000, 60);
        for (const Bounce& bounce : bounces) {
            ASSERT_FLOAT_EQ(bounce.weight, bounce.ray_count == 2 ? 0.7f : 0.0f) << chapter;
            dropped += bounce.ray_count != 2;
        }
        EXPECT_LE(dropped, 10u) << chapter;
    }
}

}  // namespace
}  // namespace lab
