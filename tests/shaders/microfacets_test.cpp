// Microfacets at a single surface point, for the chapters that have them: BSDF, density and samples.
#include "scene/microfacets.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "rendering/renderer.h"
#include "support/bounce.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/microfacet_model.h"
#include "support/render.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

// Layout as in microfacets.comp.
struct Directions {
    vec3 in, out;
};
struct Result {
    vec3 brdf;
    float density;
    uint32_t carries_light;
    vec3 sampled_direction;
    vec3 sampled_weight;
    float sampled_density, density_of_sample, radiance_scale;
};

struct RoughMaterial {
    Material material;
    Microfacets facets;
};

RoughMaterial rough_opaque(float alpha, float metalness, const vec3& colour, float index = 1.5f) {
    RoughMaterial result{white_material(), {}};
    result.material.diffuse_albedo = colour;
    result.facets.roughness = alpha;
    result.facets.metalness = metalness;
    result.facets.coat_index = index;
    integrate_albedo(result.facets);
    return result;
}

RoughMaterial rough_glass(float alpha, float index = 1.5f) {
    RoughMaterial result{white_material(), {}};
    result.material.refractive_index = index;
    result.facets.roughness = alpha;
    return result;
}

const std::vector<std::string> all_samplings{"SAMPLES_VISIBLE_NORMALS", "SAMPLES_NORMALS", "SAMPLES_COSINES"};

// At angles whose sine is accurate.
vec3 facing(double theta, double phi = 0) {
    return {dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta))};
}

class MicrofacetSurface : public testing::TestWithParam<std::string> {
  protected:
    static std::vector<Result> run(const RoughMaterial& material, const std::vector<Directions>& directions, uint32_t seed = 1,
                                   const std::vector<std::string>& defines = {}) {
        struct Header {
            Material material;
            Microfacets facets;
            uvec2 key;
        };
        const Header header{material.material, material.facets, seed_key(test_seed(seed))};
        const auto header_bytes = std::as_bytes(std::span(&header, 1)), input_bytes = std::as_bytes(std::span(directions));
        std::vector<std::byte> inputs(header_bytes.begin(), header_bytes.end());
        inputs.insert(inputs.end(), input_bytes.begin(), input_bytes.end());
        std::vector<Result> results(directions.size());
        run_shader({"microfacets.comp", defines, named_includes(chapter_estimator(GetParam()))}, results.size(),
                   std::as_writable_bytes(std::span(results)), inputs);
        return results;
    }

    // Samples directions for light that leaves along this one.
    static std::vector<Result> sample(const RoughMaterial& material, const vec3& out, size_t count, uint32_t seed,
                                      const std::vector<std::string>& defines = {}) {
        return run(material, std::vector<Directions>(count, {{0, 0, 1}, out}), seed, defines);
    }

    // Expects the samples' mean weight to be this albedo; that relative error would have been found.
    static void expect_albedo(const std::string& what, const std::vector<Result>& results, double expected, double largest_error,
                              size_t comparisons) {
        std::vector<double> weights;
        for (const Result& result : results) weights.push_back(result.sampled_weight.g);
        expect_mean(what, estimate_mean(weights), expected, largest_error, comparisons);
    }
};
INSTANTIATE_TEST_SUITE_P(Chapters, MicrofacetSurface, testing::ValuesIn(chapters_that(handles_microfacets)), bsdf_name);

// One channel by definition, for a surface with its normal along z; for glass the side of `out` is air.
struct Definition {
    double alpha, index, metalness, colour;
    bool is_glass;

    double smith(double cosine) const { return std::sqrt(cosine * cosine + alpha * alpha * (1 - cosine * cosine)); }
    double facets(const dvec3& m) const {
        const double a = alpha * alpha * m.z * m.z + m.x * m.x + m.y * m.y;
        return alpha * alpha / (pi * a * a);
    }
    double fresnel(double cosine) const {
        const double metal = colour + (1 - colour) * std::pow(1 - cosine, 5);
        return glm::mix(dielectric_fresnel(cosine, index), metal, metalness);
    }
    // The BSDF without its diffuse part, and the density of visible normals.
    std::pair<double, double> bsdf_and_density(const dvec3& in, const dvec3& out) const {
        const double eta = in.z > 0 ? 1 : index;
        dvec3 m = glm::normalize(out + eta * in);
        if (m.z < 0) m = -m;
        const double m_i = glm::dot(m, in), m_o = glm::dot(m, out), half = m_o + eta * m_i;
        if (m_o <= 0 || m_i * in.z <= 0) return {0, 0};
        const double lambda_i = 0.5 * (smith(in.z) / std::abs(in.z) - 1), lambda_o = 0.5 * (smith(out.z) / out.z - 1);
        const double reflectance = fresnel(m_o), visible = facets(m) * m_o / (out.z * (1 + lambda_o));
        if (in.z > 0)
            return {reflectance * facets(m) / (1 + lambda_i + lambda_o) / (4 * in.z * out.z),
                    visible / (4 * m_o) * (is_glass ? reflectance : 1)};
        const double shared = (1 - reflectance) * std::abs(m_i) / (half * half);
        return {shared * m_o * facets(m) / ((1 + lambda_i) * (1 + lambda_o)) / (in.z * out.z), shared * eta * eta * visible};
    }
};

TEST_P(MicrofacetSurface, HasTheBsdfAndTheDensityOfTheDefinition) {
    std::mt19937 generator(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const float alpha : {1e-4f, 1e-3f, 0.05f, 0.3f, 1.0f})
        for (const float index : {0.0f, 1.5f, 2.5f}) {  // 0: metal
            const bool is_glass = index > 0;
            const RoughMaterial material = is_glass ? rough_glass(alpha, index) : rough_opaque(alpha, 1, vec3(0.6f));
            const Definition definition{alpha, is_glass ? index : 1.5, is_glass ? 0.0 : 1.0, double{0.6f}, is_glass};
            std::vector<Directions> directions;
            while (directions.size() < 10'000) {
                const dvec3 out(facing(1.57 * uniform(generator), 6.28 * uniform(generator)));
                // A facet drawn from D, and the direction that it reflects or refracts to.
                const double u = uniform(generator), phi = 6.28 * uniform(generator);
                const double tangent = alpha * std::sqrt(u / (1 - u));
                const dvec3 m = glm::normalize(dvec3(tangent * std::cos(phi), tangent * std::sin(phi), 1));
                const double m_o = glm::dot(m, out);
                dvec3 in = 2 * m_o * m - out;
                if (is_glass && directions.size() % 2)
                    in = ((m_o - std::sqrt(index * index - 1 + m_o * m_o)) * m - out) / double{index};
                if (m_o > 0 && (in.z > 0) == (!is_glass || directions.size() % 2 == 0))
                    directions.push_back({vec3(glm::normalize(in)), vec3(out)});
            }
            double worst = 0, worst_density = 0;
            const auto results = run(material, directions);
            for (size_t i = 0; i < results.size(); ++i) {
                const auto [bsdf, density] = definition.bsdf_and_density(glm::normalize(dvec3(directions[i].in)),
                                                                         glm::normalize(dvec3(directions[i].out)));
                // Facets that one of the directions sees almost edge-on.
                if (bsdf == 0 || results[i].density == 0) continue;
                // m is rounded by 2^-24 over the length of the sum that it lies along, and D varies on the scale of α; the
                // cosines are rounded, too.
                const dvec3 sum =
                    dvec3(directions[i].out) + (directions[i].in.z > 0 ? 1.0 : double{index}) * dvec3(directions[i].in);
                const double cosine = std::abs(glm::dot(sum, dvec3(directions[i].out))) / glm::length(sum);
                const double unit = 1e-6 + 0x1p-24 * (1 / (alpha * glm::length(sum)) + 1 / cosine + 1 / glm::length(sum));
                worst = std::max(worst, std::abs(results[i].brdf.g / bsdf - 1) / unit);
                worst_density = std::max(worst_density, std::abs(results[i].density / density - 1) / unit);
            }
            std::printf(
                "  alpha %g, index %g: largest error %.2g of the BSDF, %.2g of the density, in units of what roundings explain\n",
                double{alpha}, double{index}, worst, worst_density);
            EXPECT_LT(worst, 8);
            EXPECT_LT(worst_density, 8);
        }
}

TEST_P(MicrofacetSurface, IsReciprocal) {
    std::mt19937 generator(2);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const float alpha : {0.01f, 0.1f, 0.5f, 1.0f})
        for (const RoughMaterial& material : {rough_opaque(alpha, 1, vec3(0.9f, 0.6f, 0.3f)), rough_opaque(alpha, 0, vec3(0.8f)),
                                              rough_opaque(alpha, 0.5f, vec3(0.5f)), rough_glass(alpha)}) {
            const bool is_glass = material.material.refractive_index > 0;
            std::vector<Directions> directions;
            for (int i = 0; i < 10'000; ++i) {
                const vec3 out = facing(1.57 * uniform(generator), 6.28 * uniform(generator));
                vec3 in = facing(1.57 * uniform(generator), 6.28 * uniform(generator));
                if (is_glass && i % 2) in.z = -in.z;
                directions.push_back({in, out});
                directions.push_back({out, in});
            }
            double difference = 0, sum = 0;
            const auto results = run(material, directions, 1, {"FEATURE_MULTIPLE_SCATTERING"});
            for (size_t i = 0; i < results.size(); i += 2) {
                // Radiance grows by η² on entering glass.
                const float scale = directions[i].in.z < 0 ? 1.5f * 1.5f : 1;
                const vec3 there = scale * results[i].brdf, back = results[i + 1].brdf;
                difference += glm::distance(dvec3(there), dvec3(back));
                sum += glm::length(dvec3(there));
            }
            std::printf("  alpha %g, metalness %g%s: mean relative difference %.2g\n", double{alpha},
                        double{material.facets.metalness}, is_glass ? ", glass" : "", difference / sum);
            EXPECT_LT(difference / sum, 1e-5 + 4 * 0x1p-24 / double{alpha});
            EXPECT_GT(sum, 100);
        }
}

// Nori's test of microfacets (Assignment 5 of its course) states the reflectance of a surface with Beckmann facets of α = 0.1 and
// index 1.5046 / 1.000277, with a share of 0.8 beside a diffuse one. At normal incidence what remains is the diffuse albedo.
TEST(MicrofacetModel, GivesTheNumbersThatAnotherCourseStates) {
    const std::pair<double, double> stated[] = {{0, 0.207067}, {45, 0.215733}, {60, 0.247884}, {80, 0.430936}, {85, 0.519016}};
    const auto reflected = [](double degrees) {
        return integrate_reflected(beckmann(0.1), std::cos(degrees * pi / 180),
                                   [](double cosine) { return dielectric_fresnel(cosine, 1.5046 / 1.000277); });
    };
    const double diffuse = stated[0].second - 0.8 * reflected(0);
    for (const auto& [degrees, number] : stated) {
        const double found = diffuse + 0.8 * reflected(degrees);
        std::printf("  %g degrees: %.6f, stated %.6f\n", degrees, found, number);
        EXPECT_NEAR(found, number, 1e-3 * number);
    }
}

TEST_P(MicrofacetSurface, ReflectsWhatTheFacetsDoHoweverItIsSampled) {
    struct Case {
        size_t sampling;
        float alpha;
        double degrees, largest_error;
    };
    // Normals drawn from D are hardly ever among the few that a grazing direction sees, and cosine samples hardly ever hit a
    // narrow lobe.
    const Case cases[] = {{0, 1e-4f, 0, 0.001},  {0, 1e-4f, 85, 0.001}, {0, 0.01f, 60, 0.001}, {0, 0.1f, 0, 0.003},
                          {0, 0.1f, 85, 0.005},  {0, 0.4f, 60, 0.01},   {0, 1, 0, 0.02},       {0, 1, 85, 0.01},
                          {1, 1e-4f, 60, 0.001}, {1, 0.1f, 0, 0.003},   {1, 0.1f, 60, 0.01},   {1, 0.4f, 60, 0.03},
                          {2, 0.4f, 0, 0.02},    {2, 0.4f, 60, 0.03},   {2, 1, 60, 0.02}};
    uint32_t seed = 500;
    for (const Case& c : cases) {
        const double angle = c.degrees * pi / 180;
        const auto fresnel = [](double cosine) { return 0.5 + 0.5 * std::pow(1 - cosine, 5); };
        char name[100];
        std::snprintf(name, sizeof name, "%s, alpha %g, %g degrees", all_samplings[c.sampling].c_str(), double{c.alpha},
                      c.degrees);
        expect_albedo(name,
                      sample(rough_opaque(c.alpha, 1, vec3(0.5f)), facing(angle), 400'000, ++seed,
                             {"FACET_SAMPLING " + all_samplings[c.sampling]}),
                      integrate_reflected(ggx(c.alpha), std::cos(angle), fresnel), c.largest_error, std::size(cases));
    }
}

// Which fractions of the light are reflected and transmitted, seen from outside and from inside.
TEST_P(MicrofacetSurface, OfGlassReflectsAndRefractsWhatTheFacetsDo) {
    uint32_t seed = 600;
    for (const std::string& sampling : {all_samplings[0], all_samplings[1]})
        for (const float alpha : {1e-3f, 0.5f})
            for (const double degrees : {50.0, 130.0}) {
                const double cosine = std::cos(degrees * pi / 180), index = cosine > 0 ? 1.5 : 1 / 1.5;
                const auto fresnel = [&](double c) { return dielectric_fresnel(c, index); };
                const double expected[] = {integrate_reflected(ggx(alpha), std::abs(cosine), fresnel),
                                           integrate_refracted(ggx(alpha), std::abs(cosine), index)};
                std::vector<double> weights[2];
                for (const Result& result :
                     sample(rough_glass(alpha), facing(degrees * pi / 180), 500'000, ++seed, {"FACET_SAMPLING " + sampling})) {
                    const bool is_refracted = result.radiance_scale != 1;
                    weights[is_refracted].push_back(result.sampled_weight.g);
                    weights[!is_refracted].push_back(0);
                    if (result.sampled_density > 0) {
                        ASSERT_EQ((result.sampled_direction.z > 0) == (cosine > 0), !is_refracted);
                    }
                }
                for (const bool is_refracted : {false, true}) {
                    if (expected[is_refracted] < 1e-3) continue;
                    char name[120];
                    std::snprintf(name, sizeof name, "%s, alpha %g, %g degrees, %s", sampling.c_str(), double{alpha}, degrees,
                                  is_refracted ? "refracted" : "reflected");
                    expect_mean(name, estimate_mean(weights[is_refracted]), expected[is_refracted], 0.06, 16);
                }
            }
}

// Facets that absorb nothing still lose the light that they reflect onto each other. With it, white metal is as bright as the
// sky; a white material under a coat always is. The table of albedos is approximate, so a small difference is expected.
TEST_P(MicrofacetSurface, OfWhiteMaterialsVanishesInTheFurnace) {
    const std::vector<std::string> defines{"FEATURE_MULTIPLE_SCATTERING"};
    constexpr int rows = 800, columns = 320;
    for (const float metalness : {0.0f, 1.0f})
        for (const float alpha : {0.04f, 0.3f, 1.0f})
            for (const double degrees : {0.0, 60.0, 85.0}) {
                const bool is_narrow = alpha < 0.1f;
                if (is_narrow && degrees > 80) continue;  // too noisy, and too narrow for the grid
                const vec3 out = facing(degrees * pi / 180);
                const RoughMaterial material = rough_opaque(alpha, metalness, vec3(1));
                double albedo = 0, error = 0;
                if (is_narrow) {
                    std::vector<double> weights;
                    for (const Result& result : sample(material, out, 800'000, 700, defines))
                        weights.push_back(result.sampled_weight.g);
                    albedo = estimate_mean(weights).mean;
                    error = 5 * estimate_mean(weights).standard_error;
                } else {  // ∫ ρ cos θ dω over a grid
                    std::vector<Directions> grid;
                    for (int i = 0; i < rows; ++i)
                        for (int j = 0; j < columns; ++j)
                            grid.push_back({facing(std::acos((i + 0.5) / rows), pi * (j + 0.5) / columns), out});
                    const auto results = run(material, grid, 1, defines);
                    for (size_t i = 0; i < grid.size(); ++i)
                        albedo += 2 * pi / (rows * columns) * double{results[i].brdf.g} * double{grid[i].in.z};
                }
                std::printf("  metalness %g, alpha %g, %g degrees: %.6f\n", double{metalness}, double{alpha}, degrees, albedo);
                EXPECT_LT(std::abs(albedo - 1) + error, 0.001);
            }
}

TEST_P(MicrofacetSurface, NeverGivesMoreThanItReceivesNorNothing) {
    uint32_t seed = 800;
    for (const float alpha : {1e-4f, 0.1f, 1.0f})
        for (const RoughMaterial& material :
             {rough_opaque(alpha, 1, vec3(1)), rough_opaque(alpha, 0, vec3(0.8f)), rough_opaque(alpha, 0, vec3(0), 1),
              rough_glass(alpha), rough_glass(alpha, 1.001f), rough_glass(alpha, 100)}) {
            // Under a coat that reflects little, steep facets that reflect everything are sampled too rarely.
            const float most = material.material.refractive_index > 0 || material.facets.metalness == 1 ? 1.01f : 30;
            std::vector<Directions> directions;
            for (const double below_horizon : {1e-7, 1e-5, 1e-3, 0.1, 1.5})
                directions.insert(directions.end(), 5'000, {{0, 0, 1}, facing(pi / 2 - below_horizon, 0.3)});
            for (const Result& result : run(material, directions, ++seed)) {
                ASSERT_TRUE(std::isfinite(result.sampled_weight.g));
                ASSERT_GE(result.sampled_weight.g, 0);
                ASSERT_LE(result.sampled_weight.g, most);
                if (result.sampled_density > 0) {
                    ASSERT_LT(result.sampled_density, 1e30f);
                }
            }
        }
}

// The density of each strategy integrates to the fraction of samples that are kept, and those samples follow it.
TEST_P(MicrofacetSurface, HasADensityThatAddsUpHoweverItIsSampled) {
    constexpr int rows = 600, columns = 300;  // of a hemisphere; symmetric about the plane of incidence
    const vec3 out = facing(50 * pi / 180);
    std::vector<Directions> grid;
    for (int i = -rows; i < rows; ++i)
        for (int j = 0; j < columns; ++j) grid.push_back({facing(std::acos((i + 0.5) / rows), pi * (j + 0.5) / columns), out});
    uint32_t seed = 1000;
    for (const std::string& sampling : all_samplings)
        for (const RoughMaterial& material :
             {rough_opaque(0.4f, 1, vec3(1)), rough_opaque(0.4f, 0, vec3(0.5f)), rough_glass(0.4f)}) {
            double sum = 0;
            for (const Result& result : run(material, grid, 1, {"FACET_SAMPLING " + sampling}))
                sum += 2 * pi / (rows * columns) * (result.carries_light ? double{result.density} : 0);
            std::vector<double> kept;
            for (const Result& result : sample(material, out, 800'000, ++seed, {"FACET_SAMPLING " + sampling})) {
                kept.push_back(result.sampled_density > 0);
                ASSERT_EQ(result.sampled_density, kept.back() * double{result.density_of_sample});
            }
            expect_mean(sampling, estimate_mean(kept), sum, 0.005, 9);
        }
}

// Visible normals, binned by the fraction of steeper facets and by azimuth.
TEST_P(MicrofacetSurface, SamplesVisibleNormalsAsOftenAsTheyAreSeen) {
    constexpr size_t rows = 16, columns = 16;
    uint32_t seed = 900;
    for (const float alpha : {1e-3f, 0.3f, 1.0f})
        for (const double degrees : {0.0, 60.0}) {
            const dvec3 out(facing(degrees * pi / 180));
            const double out_lambda = ggx(alpha).lambda(std::tan(degrees * pi / 180));
            std::vector<double> probabilities(rows * columns);
            constexpr int parts = 24;  // per cell
            for (size_t i = 0; i < rows * parts; ++i)
                for (size_t j = 0; j < columns * parts; ++j) {
                    const double rest = 1 - (static_cast<double>(i) + 0.5) / (rows * parts), u = 1 - rest * rest;
                    const double phi = 2 * pi * (static_cast<double>(j) + 0.5) / (columns * parts);
                    const double tangent = alpha * std::sqrt(u / (1 - u)), cosine = 1 / std::sqrt(1 + tangent * tangent);
                    const dvec3 m = cosine * dvec3(tangent * std::cos(phi), tangent * std::sin(phi), 1);
                    probabilities[i / parts * columns + j / parts] += 2 * rest * std::max(glm::dot(m, out), 0.0) /
                                                                      (out.z * m.z * (1 + out_lambda)) /
                                                                      (rows * parts * columns * parts);
                }
            double sum = 0;
            for (const double probability : probabilities) sum += probability;
            EXPECT_NEAR(sum, 1, 1e-3);
            for (double& probability : probabilities) probability /= sum;
            std::vector<uint64_t> counts(rows * columns);
            for (const Result& result : sample(rough_opaque(alpha, 1, vec3(1)), vec3(out), 500'000, ++seed)) {
                const dvec3 m = glm::normalize(glm::normalize(dvec3(result.sampled_direction)) + out);
                const double square = (m.x * m.x + m.y * m.y) / (m.z * m.z),
                             steeper = alpha / std::sqrt(square + double{alpha} * double{alpha});
                const double around = std::atan2(m.y, m.x) / (2 * pi);
                ++counts[std::min(static_cast<size_t>((1 - steeper) * rows), rows - 1) * columns +
                         std::min(static_cast<size_t>((around < 0 ? around + 1 : around) * columns), columns - 1)];
            }
            char name[60];
            std::snprintf(name, sizeof name, "alpha %g, %g degrees", double{alpha}, degrees);
            expect_distribution(name, counts, probabilities, 0.03);
        }
}

}  // namespace
}  // namespace lab
