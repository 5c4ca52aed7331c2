// Chapter 6's Fresnel reflectance, refraction and choice between the two directions, against the textbook's formulas in long
// double: those cancel if the indices are nearly equal, but have 11 bits more than double to lose.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "shaders/interface.h"
#include "support/device_arithmetic.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/pcg2d.h"
#include "support/render.h"

namespace lab {
namespace {

using glm::dvec3;

// The random state that yields u next.
RandomState seed_of(double u) { return state_before(static_cast<uint64_t>(std::max(u, 0.0) * 0x1p64)); }

// Layout as in fresnel.comp.
struct DielectricInput {
    vec3 normal{0, 0, 1};
    vec3 out_direction;
    float eta;
    float eta_cos_theta_t = 0;
    RandomState seed = seed_of(0);
};
struct DielectricResult {
    float reflectance;
    vec3 direction;
};

std::vector<DielectricResult> evaluate(const std::vector<DielectricInput>& inputs) {
    TestShader shader{.name = "fresnel.comp"};
    shader.named_includes = {{"path_trace.glsl", chapter_estimator(chapter_named("dielectrics")).file}};
    return run_shader<DielectricResult>(shader, inputs);
}

// Indices from nearly equal ones to diamond, from both sides.
const std::vector<float> test_etas{1, 1 + 1e-6f, 1 - 1e-6f, 1 + 1e-4f, 1 - 1e-4f, 1.5f, 1 / 1.5f, 2.4f, 1 / 2.4f};

// Cosines from grazing to normal incidence, evenly spaced on a logarithmic scale.
std::vector<float> test_cosines() {
    constexpr int count = 600;
    std::vector<float> cosines;
    for (int i = 0; i <= count; ++i) cosines.push_back(static_cast<float>(std::pow(10.0, -6.0 * i / count)));
    return cosines;
}

// Fresnel's formulas with Snell's law.
struct Textbook {
    bool is_total;  // no refracted direction
    long double cos_theta_t = 0;
    long double reflectance = 1;

    Textbook(long double cos_theta, long double eta) {
        const long double sin_squared = (1 - cos_theta * cos_theta) / (eta * eta);
        is_total = sin_squared >= 1;
        if (is_total) return;
        cos_theta_t = std::sqrt(1 - sin_squared);
        const long double r_s = (cos_theta - eta * cos_theta_t) / (cos_theta + eta * cos_theta_t);
        const long double r_p = (eta * cos_theta - cos_theta_t) / (eta * cos_theta + cos_theta_t);
        reflectance = 0.5L * (r_s * r_s + r_p * r_p);
    }
};

// How much the reflectance changes if the cosine and the difference of the indices change by a few ulps: near the critical angle
// that is far more than an ulp, and no formula can do better.
double rounding_effect(double cos_theta, double eta) {
    const long double exact = Textbook(cos_theta, eta).reflectance;
    long double largest = 0;
    for (const long double factor : {1 - 0x1p-22L, 1 + 0x1p-22L})
        largest = std::max({largest, std::abs(Textbook(std::min(1.0L, cos_theta * factor), eta).reflectance - exact),
                            std::abs(Textbook(cos_theta, 1 + (eta - 1.0L) * factor).reflectance - exact)});
    return static_cast<double>(largest);
}

// Direction in the xz-plane whose cosine to the z-axis is exactly this.
vec3 direction_of_cosine(float cos_theta) { return {std::sqrt(1 - double{cos_theta} * double{cos_theta}), 0, cos_theta}; }

DielectricInput make_input(float cos_theta, float eta, double u = 0) {
    const long double eta_cos_theta_t = eta * Textbook(cos_theta, eta).cos_theta_t;
    return {.out_direction = direction_of_cosine(cos_theta),
            .eta = eta,
            .eta_cos_theta_t = static_cast<float>(eta_cos_theta_t),
            .seed = seed_of(u)};
}

bool is_reflected(const DielectricInput& input, const DielectricResult& result) {
    return glm::dot(input.normal, result.direction) > 0;
}

// The largest number below 1: it selects refraction, if there is any.
constexpr double refract = 1 - 0x1p-53;

TEST(Fresnel, IsTheTextbooksReflectance) {
    double worst_of_all = 0;
    for (const float eta : test_etas) {
        std::vector<DielectricInput> inputs;
        for (const float cos_theta : test_cosines())
            if (!Textbook(cos_theta, eta).is_total) inputs.push_back(make_input(cos_theta, eta));
        const auto results = evaluate(inputs);
        double worst = 0;
        for (size_t i = 0; i < inputs.size(); ++i) {
            const auto expected = static_cast<double>(Textbook(inputs[i].out_direction.z, eta).reflectance);
            if (eta == 1)
                ASSERT_EQ(results[i].reflectance, 0) << "equal indices reflect nothing";
            else
                worst = std::max(worst, std::abs(results[i].reflectance / expected - 1));
        }
        std::printf("  index ratio %.7f: largest relative error of the reflectance %.2g\n", eta, worst);
        // Squared quotients of sums, each with two rounding errors.
        EXPECT_LT(worst, 4 * test_arithmetic().division + 1e-6) << eta;
        worst_of_all = std::max(worst_of_all, worst);
    }
    record("largest_relative_error_of_the_reflectance", "%.1e", worst_of_all);
}

TEST(Dielectric, ReflectsIfTheRandomNumberIsBelowTheReflectance) {
    double widest = 0;
    for (const float eta : test_etas) {
        std::vector<DielectricInput> inputs;
        std::vector<bool> is_total;
        for (const float cos_theta : test_cosines()) {
            const auto reflectance = static_cast<double>(Textbook(cos_theta, eta).reflectance);
            const double error = 1e-6 * reflectance + rounding_effect(cos_theta, eta);
            if (reflectance < 1) widest = std::max(widest, error);
            inputs.push_back(make_input(cos_theta, eta, reflectance - error));
            inputs.push_back(make_input(cos_theta, eta, std::min(reflectance + error, refract)));
            is_total.push_back(reflectance + error >= 1);
        }
        const auto results = evaluate(inputs);
        for (size_t i = 0; i < inputs.size(); i += 2) {
            const float cos_theta = inputs[i].out_direction.z;
            const std::string what = std::to_string(eta) + ", cosine " + std::to_string(cos_theta);
            ASSERT_TRUE(eta == 1 || is_reflected(inputs[i], results[i])) << what;
            ASSERT_TRUE(is_total[i / 2] || !is_reflected(inputs[i + 1], results[i + 1])) << what;
        }
    }
    std::printf("  the threshold is that of the textbook up to %.2g, and 1e-6 where it is not critical\n", widest);
}

TEST(Dielectric, ReflectsTotallyBelowTheCriticalAngle) {
    int widest = 0;
    for (const float eta : test_etas) {
        if (eta >= 1) continue;
        const auto critical = static_cast<float>(std::sqrt((1 - static_cast<long double>(eta)) * (1 + eta)));
        constexpr int ulps = 16;
        std::vector<DielectricInput> inputs;
        float cos_theta = critical;
        for (int i = 0; i < ulps; ++i) cos_theta = std::nextafter(cos_theta, 0.0f);
        for (int i = -ulps; i <= ulps; ++i, cos_theta = std::nextafter(cos_theta, 1.0f))
            inputs.push_back(make_input(cos_theta, eta, refract));
        const auto results = evaluate(inputs);
        int width = 0;
        for (int i = -ulps; i <= ulps; ++i) {
            const size_t index = static_cast<size_t>(i + ulps);
            const bool is_total = Textbook(inputs[index].out_direction.z, eta).is_total;
            if (is_reflected(inputs[index], results[index]) != is_total) width = std::max(width, std::abs(i));
            EXPECT_LT(std::abs(glm::length(dvec3(results[index].direction)) - 1), 1e-6);
        }
        std::printf("  index ratio %.7f: critical cosine exact to %d ulp\n", eta, width);
        EXPECT_LE(width, 1) << eta;
        widest = std::max(widest, width);
    }
    record("error_of_the_critical_cosine", "%d ulp", widest);
}

TEST(Dielectric, OfIndexOneIsTransparent) {
    std::vector<DielectricInput> inputs;
    for (const float cos_theta : test_cosines()) inputs.push_back(make_input(cos_theta, 1));
    const auto results = evaluate(inputs);
    for (size_t i = 0; i < inputs.size(); ++i) {
        ASSERT_FALSE(is_reflected(inputs[i], results[i]));
        // Up to the rounding of the normalisation: some devices multiply by the inverse length.
        ASSERT_LT(glm::distance(dvec3(results[i].direction), -dvec3(inputs[i].out_direction)), 0x1p-22);
    }
}

// Surfaces and directions in general position, for each ratio of indices.
std::vector<DielectricInput> random_inputs(double u) {
    std::mt19937 generator(2);
    std::normal_distribution<double> normal;
    const auto direction = [&] { return glm::normalize(dvec3(normal(generator), normal(generator), normal(generator))); };
    std::vector<DielectricInput> inputs;
    for (const float eta : test_etas)
        for (int i = 0; i < 20'000; ++i) {
            const dvec3 n = direction();
            dvec3 out = direction();
            if (glm::dot(n, out) < 0) out = -out;
            inputs.push_back({.normal = vec3(n), .out_direction = vec3(out), .eta = eta, .seed = seed_of(u)});
        }
    return inputs;
}

TEST(Dielectric, RefractsBySnellsLaw) {
    const auto inputs = random_inputs(refract);
    const auto results = evaluate(inputs);
    double worst_snell = 0, worst_plane = 0, worst_length = 0;
    size_t refracted = 0;
    for (size_t i = 0; i < inputs.size(); ++i) {
        if (is_reflected(inputs[i], results[i])) continue;
        ++refracted;
        const dvec3 n = glm::normalize(dvec3(inputs[i].normal)), out(inputs[i].out_direction), direction(results[i].direction);
        // η sin θ_t = sin θ, in the same plane and on the other side.
        const dvec3 sine = glm::cross(n, out), sine_t = glm::cross(-n, direction);
        worst_snell = std::max(worst_snell, glm::length(double{inputs[i].eta} * sine_t - sine));
        worst_plane = std::max(worst_plane, std::abs(glm::dot(direction, sine)));
        worst_length = std::max(worst_length, std::abs(glm::length(direction) - 1));
    }
    std::printf("  %zu directions: residual of Snell's law %.2g, distance to the plane %.2g, length off by %.2g\n", refracted,
                worst_snell, worst_plane, worst_length);
    record("residual_of_the_law_of_refraction", "%.1e", worst_snell);
    record("largest_error_of_a_length", "%.1e", worst_length);
    EXPECT_GT(refracted, inputs.size() / 2);
    EXPECT_LT(worst_snell, 1e-6);
    EXPECT_LT(worst_plane, 1e-6);
    EXPECT_LT(worst_length, 1e-6);
}

TEST(Dielectric, ReflectsLikeAMirror) {
    auto inputs = random_inputs(0);
    const auto results = evaluate(inputs);
    double worst = 0;
    for (size_t i = 0; i < inputs.size(); ++i) {
        if (inputs[i].eta == 1) continue;
        const dvec3 n = glm::normalize(dvec3(inputs[i].normal)), out(inputs[i].out_direction);
        worst = std::max(worst, glm::distance(dvec3(results[i].direction), 2 * glm::dot(n, out) * n - out));
    }
    std::printf("  largest error of a mirrored direction %.2g\n", worst);
    EXPECT_LT(worst, 1e-6);
}

}  // namespace
}  // namespace lab
