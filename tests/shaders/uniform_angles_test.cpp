// Chapter 1's direction sampling: uniform inclination and azimuth, density 1/(π² sin θ) per solid angle.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "support/bounce.h"
#include "support/device_arithmetic.h"
#include "support/directions.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

const std::string chapter = chapter_named("uniform_sampling");

std::vector<Bounce> sample(const dvec3& normal, size_t count, uint32_t run) {
    return sample_bounces(chapter, {vec3(normal), vec3(normal), white_material()}, count, run);
}

// The probability of cos θ < c, exact because the inclination is uniform.
double integral(double c) { return 1 - 2 / pi * std::acos(c); }

TEST(UniformAngles, FollowTheirDensity) {
    uint32_t run = 0;
    for (const dvec3& normal : test_normals()) {
        const auto bounces = sample(normal, 4'000'000, ++run);
        expect_distribution("normal " + std::to_string(run) + ", 16 x 32 cells", histogram(bounces, Frame(normal), 16, 32),
                            cell_probabilities(16, 32, integral), 0.01);
        // Odd numbers, so that the middle of the range lies inside a cell.
        expect_distribution("normal " + std::to_string(run) + ", 51 x 102 cells", histogram(bounces, Frame(normal), 51, 102),
                            cell_probabilities(51, 102, integral), 0.015);
    }
}

TEST(UniformAngles, HaveTheDensityOfTheJacobian) {
    // |det J| of the map from random numbers to directions is solid angle per unit area: 1 / density = π² sin θ. Central
    // differences over 2^-8 have an error of at most 1e-4.
    constexpr double step = 0x1p-9;
    std::vector<std::array<double, 2>> numbers;
    for (int x = 0; x < 128; ++x)
        for (int y = 0; y < 128; ++y) {
            const double u = (x + 0.5) / 128, v = (y + 0.5) / 128;
            numbers.insert(numbers.end(), {{u - step, v}, {u + step, v}, {u, v - step}, {u, v + step}});
        }
    const auto bounces = bounces_at(chapter, {{0, 0, 1}, {0, 0, 1}, white_material()}, numbers);
    double worst = 0;
    for (size_t i = 0; i < numbers.size(); i += 4) {
        const auto difference = [&](size_t k) {
            return (dvec3(bounces[i + k + 1].direction) - dvec3(bounces[i + k].direction)) / (2 * step);
        };
        const double solid_angle = glm::length(glm::cross(difference(0), difference(2)));
        const double expected = pi * pi * std::sin(0.5 * pi * numbers[i][1]);
        worst = std::max(worst, std::abs(solid_angle / expected - 1));
    }
    std::printf("  largest relative difference of Jacobian and density %.2g\n", worst);
    // Differences over 2^-8 magnify the errors of the sines.
    EXPECT_LT(worst, 1e-4 + 1000 * test_arithmetic().sine);
}

TEST(UniformAngles, AreWeightedByReflectanceTimesCosineOverDensity) {
    uint32_t run = 20;
    for (const dvec3& normal : test_normals()) {
        const Frame frame(normal);
        double worst = 0;
        for (const Bounce& bounce : sample(normal, 100'000, ++run)) {
            if (bounce.ray_count != 2) continue;
            const Angles angles = frame.angles(bounce.direction);
            const double density = 1 / (pi * pi * angles.sin_theta);
            const double expected = 1 / pi * angles.cos_theta / density;
            worst = std::max(worst, std::abs(bounce.weight - expected));
        }
        std::printf("  normal %u: largest error of a weight %.2g\n", run - 20, worst);
        // The reference direction contains the sines' errors as well.
        EXPECT_LT(worst, 8 * test_arithmetic().sine + 1e-6);
    }
}

TEST(UniformAngles, HaveTheKnownMeansAndVariance) {
    std::vector<double> weights, squared_deviations, solid_angles;
    uint32_t run = 30;
    for (const dvec3& normal : test_normals()) {
        const Frame frame(normal);
        for (const Bounce& bounce : sample(normal, 3'200'000, ++run)) {
            const double weight = bounce.ray_count == 2 ? bounce.weight : 0;
            weights.push_back(weight);
            squared_deviations.push_back((weight - 1) * (weight - 1));
            solid_angles.push_back(pi * pi * frame.angles(bounce.direction).sin_theta);
        }
    }
    expect_mean("radiance of a white surface under a white sky", estimate_mean(weights), 1, 0.001);
    expect_mean("variance of one sample, π²/8 - 1", estimate_mean(squared_deviations), pi * pi / 8 - 1, 0.01);
    expect_mean("mean of 1 / density, the solid angle of the hemisphere", estimate_mean(solid_angles), 2 * pi, 0.001);
}

}  // namespace
}  // namespace lab
