// shaders/world/frame.glsl: the rotation from the z-axis to a normal.
#include <cmath>
#include <random>

#include "shaders/interface.h"
#include "support/gpu_test.h"

namespace lab {
namespace {

vec3 unit_vector(double x, double y, double z) { return vec3(glm::normalize(glm::dvec3(x, y, z))); }

std::vector<vec3> hard_normals() {
    std::vector<vec3> normals{
        // Frisvad's construction fails for these two: Duff et al., "Building an Orthonormal Basis, Revisited".
        {0.00038527316f, 0.00038460016f, -0.99999988079f},
        {-0.00019813581f, -0.00008946839f, -0.99999988079f},
    };
    for (const float sign : {1.0f, -1.0f})
        for (const float zero : {0.0f, -0.0f}) {
            normals.push_back({sign, zero, zero});
            normals.push_back({zero, sign, zero});
            normals.push_back({zero, zero, sign});
        }
    // Directions whose distance to the z-axis is log-uniform over all orders of magnitude.
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 1'000'000; ++i) {
        const double radius = std::pow(10.0, -20 * uniform(generator)), angle = 6.283185307179586 * uniform(generator);
        const double z = std::sqrt((1 - radius) * (1 + radius));
        normals.push_back(unit_vector(radius * std::cos(angle), radius * std::sin(angle), i % 2 == 0 ? z : -z));
    }
    // And directions near the xy-plane, where the sign of z changes.
    for (int i = 0; i < 100'000; ++i) {
        const double angle = 6.283185307179586 * uniform(generator);
        const double z = std::pow(10.0, -20 * uniform(generator));
        normals.push_back(unit_vector(std::cos(angle), std::sin(angle), i % 2 == 0 ? z : -z));
    }
    return normals;
}

TEST(ShadingSpace, IsARotationThatTakesZToTheNormal) {
    const auto normals = hard_normals();
    const auto frames = run_shader<mat3>({"frame.comp"}, normals);
    double worst = 0;
    for (size_t i = 0; i < normals.size(); ++i) {
        ASSERT_EQ(frames[i][2], normals[i]);
        const glm::dmat3 frame(frames[i]);
        const glm::dmat3 product = glm::transpose(frame) * frame;
        double error = std::abs(glm::determinant(frame) - 1);  // -1 if left-handed
        for (int column = 0; column < 3; ++column)
            for (int row = 0; row < 3; ++row) error = std::max(error, std::abs(product[column][row] - (row == column)));
        ASSERT_LT(error, 1e-6) << "normal " << normals[i].x << " " << normals[i].y << " " << normals[i].z;
        worst = std::max(worst, error);
    }
    record("largest_deviation_from_an_orthonormal_basis", "%.1e", worst);
}

}  // namespace
}  // namespace lab
