// shaders/world/materials.glsl: the Lambertian BRDF with a normalised Phong lobe.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "support/bounce.h"
#include "support/device_arithmetic.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/render.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

// Layout as in brdf.comp.
struct BrdfInput {
    vec3 normal;
    vec3 in_direction;
    vec3 out_direction;
    Material material;
};
struct BrdfResult {
    vec3 brdf;
    uint32_t is_above;
};

std::vector<BrdfResult> evaluate(const std::vector<BrdfInput>& inputs) { return run_shader<BrdfResult>({"brdf.comp"}, inputs); }

Material glossy_material(float exponent) {
    Material material = white_material();
    material.diffuse_albedo = {0.1f, 0.2f, 0.3f};
    material.specular_albedo = {0.6f, 0.5f, 0.4f};
    material.specular_exponent = exponent;
    return material;
}

// The BRDF of one channel, by definition.
double brdf(const BrdfInput& input, int channel) {
    const dvec3 n(input.normal), in(input.in_direction), out(input.out_direction);
    const double cos_alpha = std::max(glm::dot(2 * glm::dot(n, in) * n - in, out), 0.0);
    const double exponent = input.material.specular_exponent;
    return (input.material.diffuse_albedo[channel] +
            input.material.specular_albedo[channel] * 0.5 * (exponent + 2) * std::pow(cos_alpha, exponent)) /
           pi;
}

// Spherical coordinates to a direction.
vec3 direction(double theta, double phi) {
    return {dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta))};
}

TEST(Brdf, IsLambertianWithANormalisedPhongLobe) {
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<BrdfInput> inputs;
    for (const float exponent : {1.0f, 10.0f, 100.0f, 1000.0f})
        for (int i = 0; i < 20'000; ++i) {
            const vec3 in = direction(1.57 * uniform(generator), 6.28 * uniform(generator));
            // Half of the directions near the mirror direction, where the lobe is.
            const vec3 mirrored(-in.x, -in.y, in.z);
            const vec3 other = direction(1.57 * uniform(generator), 6.28 * uniform(generator));
            const vec3 out = glm::normalize(i % 2 == 0 ? other : mirrored + 3 / std::sqrt(exponent) * other);
            inputs.push_back({{0, 0, 1}, in, out, glossy_material(exponent)});
            inputs.push_back({{0, 0, 1}, out, in, glossy_material(exponent)});
        }
    const auto results = evaluate(inputs);
    double worst = 0, worst_reciprocity = 0;
    for (size_t i = 0; i < inputs.size(); ++i) {
        ASSERT_EQ(results[i].is_above, 1u);
        for (int channel = 0; channel < 3; ++channel) {
            // Relative to the lobe's peak: a power of 1000 magnifies the rounding errors of its base.
            const double peak = 0.5 * (inputs[i].material.specular_exponent + 2) / pi;
            const double value = results[i].brdf[channel];
            worst = std::max(worst, std::abs(value - brdf(inputs[i], channel)) / peak);
            worst_reciprocity = std::max(worst_reciprocity, std::abs(value - results[i ^ 1].brdf[channel]) / peak);
        }
    }
    std::printf("  largest error %.2g, largest difference of exchanged directions %.2g, of the peak\n", worst, worst_reciprocity);
    // The rounding errors of the base, about 2^-23, are magnified as well.
    const double tolerance = 2 * test_arithmetic().phong_lobe + 1000 * 3 * 0x1p-24;
    EXPECT_LT(worst, tolerance);
    EXPECT_LT(worst_reciprocity, 2 * tolerance);
}

TEST(Brdf, CarriesNothingBelowTheSurface) {
    const std::vector<BrdfInput> inputs{{{0, 0, 1}, {0, 0.6f, -0.8f}, {0, 0, 1}, white_material()},
                                        {{0, 0, 1}, {0, 1, 0}, {0, 0, 1}, white_material()},
                                        // seen from behind, the surface reflects backwards
                                        {{0, 0, 1}, {0, 0.6f, -0.8f}, {0, 0, -1}, white_material()},
                                        {{0, 0, 1}, {0, 0.6f, 0.8f}, {0, 0, -1}, white_material()}};
    const auto results = evaluate(inputs);
    EXPECT_EQ(results[0].is_above, 0u);
    EXPECT_EQ(results[1].is_above, 0u);
    EXPECT_EQ(results[2].is_above, 1u);
    EXPECT_EQ(results[3].is_above, 0u);
}

// Directions sampled from the whole BRDF, from purely diffuse to a pure mirror.
struct SampledLobe {
    float exponent;
    double degrees;  // of the outgoing light
};

class BrdfSampling : public testing::TestWithParam<std::string> {
  protected:
    // A surface whose lobe is sampled for light that leaves at this angle.
    static Surface surface(const SampledLobe& lobe, const vec3& diffuse, const vec3& specular) {
        Material material = white_material();
        material.diffuse_albedo = diffuse;
        material.specular_albedo = specular;
        material.specular_exponent = lobe.exponent;
        return {{0, 0, 1}, direction(lobe.degrees * pi / 180, 0.7), material};
    }
};
INSTANTIATE_TEST_SUITE_P(Chapters, BrdfSampling, testing::ValuesIn(chapters_that(weights_lights)), bsdf_name);

TEST_P(BrdfSampling, FollowsTheLobe) {
    // 1 - cos α increases from 0 with probability 1 - (cos α)^(n+1), and the azimuth about the mirror direction is uniform. For
    // light that leaves along the normal the whole lobe is above the surface.
    uint32_t run = 300;
    for (const float exponent : {0.0f, 1.0f, 20.0f, 1e3f, 1e6f, 1e8f}) {
        constexpr size_t rows = 16, columns = 8;
        std::vector<uint64_t> counts(rows * columns);
        for (const Bounce& bounce : sample_bounces(GetParam(), surface({exponent, 0}, vec3(0), vec3(1)), 1'000'000, ++run)) {
            ASSERT_EQ(bounce.ray_count, 2u);
            const dvec3 omega(bounce.direction);
            const double sine_square = omega.x * omega.x + omega.y * omega.y;
            const double below = -std::expm1((exponent + 1.0) / 2 * std::log1p(-std::min(sine_square, 1.0)));
            const double around = std::atan2(omega.y, omega.x) / (2 * pi) + 0.5;
            ++counts[std::min(static_cast<size_t>(below * rows), rows - 1) * columns +
                     std::min(static_cast<size_t>(around * columns), columns - 1)];
        }
        expect_distribution("exponent " + std::to_string(exponent), counts,
                            std::vector<double>(rows * columns, 1.0 / (rows * columns)), 0.02);
    }
}

TEST_P(BrdfSampling, ReflectsWhatTheBrdfSays) {
    // If all of it is above the surface, the lobe reflects k_s cos θ: ∫ (n+2)/(2π) cos^n α cos θ dω.
    uint32_t run = 400;
    for (const SampledLobe lobe : {SampledLobe{200, 50}, {1e4f, 75}, {1e6f, 80}, {1e8f, 60}, {1e4f, 0}})
        for (const float share : {0.0f, 0.3f, 0.9f, 1.0f}) {
            std::vector<double> weights;
            const Surface at = surface(lobe, vec3((1 - share) * 0.8f), vec3(share * 0.8f));
            for (const Bounce& bounce : sample_bounces(GetParam(), at, 800'000, ++run)) weights.push_back(bounce.weight);
            const double cosine = std::cos(lobe.degrees * pi / 180);
            char name[80];
            std::snprintf(name, sizeof name, "exponent %g, %g degrees, specular share %g", double{lobe.exponent}, lobe.degrees,
                          double{share});
            expect_mean(name, estimate_mean(weights), 0.8 * (1 - share + share * cosine), 0.01, 20);
        }
}

}  // namespace
}  // namespace lab
