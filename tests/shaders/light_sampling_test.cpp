// Samples on lights: which triangle, which point on it, and with which weight.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "files/project_folder.h"
#include "rendering/renderer.h"
#include "scene/light_table.h"
#include "support/bounce.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/pcg2d.h"
#include "support/render.h"

namespace lab {
namespace {

using glm::dvec2;
using glm::dvec3;
using std::numbers::pi;

template <typename T>
void append_bytes(std::vector<std::byte>& bytes, std::span<const T> objects) {
    const auto more = std::as_bytes(objects);
    bytes.insert(bytes.end(), more.begin(), more.end());
}

// A table of triangles 0, 1, 2, ... chosen with probabilities proportional to the weights.
std::vector<LightTriangle> make_table(const std::vector<double>& weights) {
    const AliasTable table = build_alias_table(weights);
    std::vector<LightTriangle> lights;
    for (uint32_t i = 0; i < weights.size(); ++i)
        lights.push_back({.instance = 0,
                          .triangle = i,
                          .threshold = table.entries[i].threshold,
                          .alias = table.entries[i].alias,
                          .inverse_density = 1});
    return lights;
}

// Layout as in light_choice.comp.
struct Choice {
    uint32_t triangle;
    vec2 u;
};

// The device's choices: first from the given random states (at least one), then with the numbers of different samples.
std::vector<Choice> choose(const std::vector<LightTriangle>& lights, const std::vector<RandomState>& states, size_t count,
                           uint32_t run, std::vector<std::string> defines = {}) {
    std::vector<std::byte> inputs;
    const uvec2 key = seed_key(test_seed(run));
    append_bytes(inputs, std::span(&key, 1));
    append_bytes(inputs, std::span(states));
    append_bytes(inputs, std::span(lights));
    std::vector<Choice> chosen(count);
    defines.push_back("STATE_COUNT " + std::to_string(states.size()));
    run_shader({"light_choice.comp", defines}, count, std::as_writable_bytes(std::span(chosen)), inputs);
    return chosen;
}

// Powers as different as in a mesh of very unequal triangles; every tenth is 0.
std::vector<double> unequal_weights(size_t count) {
    std::mt19937_64 random(count);
    std::vector<double> weights;
    for (size_t i = 0; i < count; ++i) weights.push_back(i % 10 == 5 ? 0 : std::exp(std::normal_distribution<>(0, 1.5)(random)));
    return weights;
}

// The entry that 64 bits choose: the first word, and a hash of both.
uint32_t entry_of(const RandomState& words, uint64_t count) {
    const uint64_t further = uint64_t{next_state(words)[0]} * count >> 32;
    return static_cast<uint32_t>((uint64_t{words[0]} * count + further) >> 32);
}

TEST(LightChoice, FollowsTheTableWordByWord) {
    // Words at which the choice changes: at the first and last word of an entry, at its threshold and just below. For the last
    // word, further bits decide whether the next entry is chosen.
    size_t carried = 0;
    for (const size_t n : {size_t{1}, size_t{7}, size_t{4000}, size_t{100'000}}) {
        const auto lights = make_table(unequal_weights(n));
        std::vector<RandomState> states;
        std::vector<uint32_t> expected;
        for (uint64_t i = 0; i<n; i += n> 20'000 ? n - 1 : 1) {
            const uint64_t first = ((i << 32) + n - 1) / n, last = (((i + 1) << 32) + n - 1) / n - 1;
            const uint32_t threshold = lights[i].threshold;
            for (const uint64_t word : {first, last})
                for (const uint32_t coin : {0u, threshold - 1, threshold, 0xffffffffu}) {
                    const RandomState words{static_cast<uint32_t>(word), coin};
                    const uint32_t entry = entry_of(words, n);
                    carried += entry != i;
                    states.push_back(previous_state(words));
                    expected.push_back(coin < lights[entry].threshold ? entry : lights[entry].alias);
                }
        }
        const auto chosen = choose(lights, states, states.size(), 0);
        for (size_t i = 0; i < states.size(); ++i) ASSERT_EQ(chosen[i].triangle, expected[i]) << n << " lights, state " << i;
    }
    EXPECT_GT(carried, 0u);
}

TEST(LightChoice, HasTheProbabilitiesOfTheWeights) {
    for (const size_t n : {4000u, 100'000u}) {
        const auto weights = unequal_weights(n);
        double sum = 0;
        for (const double weight : weights) sum += weight;
        std::vector<double> probabilities;
        for (const double weight : weights) probabilities.push_back(weight / sum);
        std::vector<uint64_t> counts(n);
        const auto lights = make_table(weights);
        for (const uint32_t run : {1u, 2u})
            for (const Choice& choice : choose(lights, {{1, 2}}, 8'000'000, run)) ++counts.at(choice.triangle);
        expect_distribution(std::to_string(n) + " lights", counts, probabilities, 0.02);
        EXPECT_GT(counts.front(), 0u);
        EXPECT_GT(counts.back(), 0u);
    }
}

// Chapter 9 chooses with a single pair of words. In large tables few words belong to an entry, and with 2^k entries the same
// number for all.
TEST(LightChoice, ByOnePairOfWordsHasTheProbabilitiesOfDimLights) {
    for (const size_t n : {size_t{1} << 20, size_t{1} << 22, size_t{3'000'000}}) {
        std::vector<double> weights(n, 3e-4);
        for (size_t i = 0; i < n; i += 4096) weights[i] = 4096;
        double sum = 0;
        for (const double weight : weights) sum += weight;
        const auto choices = choose(make_table(weights), {{1, 2}}, 8'000'000, 3, {"ONE_PAIR"});
        const auto dim = std::ranges::count_if(choices, [](const Choice& c) { return c.triangle % 4096 != 0; });
        const double bright = std::ceil(static_cast<double>(n) / 4096) * 4096 / sum;
        const std::vector<uint64_t> counts{static_cast<uint64_t>(dim), choices.size() - dim};
        expect_distribution(std::to_string(n) + " lights", counts, std::vector{1 - bright, bright}, 0.01);
    }
}

TEST(LightChoice, LeavesUniformNumbers) {
    for (const size_t n : {size_t{2}, size_t{1} << 22, size_t{3'000'000}}) {
        std::vector<double> weights(n, 0.2);
        for (size_t i = 0; i < n; i += 2) weights[i] = 1;
        std::vector<double> numbers[2][2];
        for (const auto& [triangle, u] : choose(make_table(weights), {{1, 2}}, 1'000'000, 4, {"ONE_PAIR"}))
            for (int axis = 0; axis < 2; ++axis) numbers[triangle % 2][axis].push_back(u[axis]);
        for (const char* parity : {"even", "odd"})
            for (int axis = 0; axis < 2; ++axis)
                expect_uniform(std::to_string(n) + " lights, " + parity + ", number " + std::to_string(axis),
                               numbers[*parity == 'o'][axis], 0.01);
    }
}

// The share of some of 49 equal lights is rounded to just below 1: only the largest words give way.
TEST(LightChoice, LeavesANumberWhereOnlyTheLargestDigitsGiveWay) {
    const auto lights = make_table(std::vector<double>(49, 1.0));
    const auto choices = choose(lights, {{1, 2}}, lights.size(), 5, {"ONE_PAIR", "LARGEST_DIGITS"});
    size_t rounded = 0;
    for (size_t i = 0; i < lights.size(); ++i)
        if (lights[i].threshold == 0xffffffffu) {
            ++rounded;
            EXPECT_EQ(choices[i].u.x, 0) << i;
        }
    EXPECT_GT(rounded, 0u);
}

// A triangle above a surface at the origin that it faces: without symmetry, and entirely above the horizon.
const std::array<vec3, 3> light_corners{vec3(-0.7f, 0.4f, 1.1f), vec3(0.3f, 0.9f, 0.8f), vec3(0.5f, -0.6f, 1.4f)};
constexpr vec3 surface_normal{0, 0, 1};
constexpr float emission = 2.5f, inverse_density = 3.5f, albedo = 0.6f;

struct LightAnswer {
    vec3 origin, to_light;  // the shadow ray
    float radiance;
    uint32_t shadow_rays;
};

std::vector<LightAnswer> sample_light(const std::string& chapter, const std::array<vec3, 3>& corners, size_t count,
                                      bool only_light_samples = false) {
    struct Inputs {
        Surface surface;
        uint32_t max_path_length;
        uvec2 key;
        std::array<vec3, 3> corners;
        Material light_material;
        LightTriangle light;
    } inputs{};
    inputs.surface = {surface_normal, glm::normalize(vec3(0.3f, 0.2f, 1)), white_material()};
    inputs.surface.material.diffuse_albedo = vec3(albedo);
    inputs.max_path_length = 1;
    inputs.key = seed_key(test_seed(80));
    inputs.corners = corners;
    inputs.light_material = white_material();
    inputs.light_material.emission = vec3(emission);
    inputs.light_material.light_density = 1 / inverse_density;
    inputs.light = {.instance = 0, .triangle = 1, .threshold = 0, .alias = 0, .inverse_density = inverse_density};
    Estimator estimator = chapter_estimator(chapter);
    if (only_light_samples) estimator.defines.emplace_back("STRATEGY STRATEGY_LIGHT");
    const TestShader shader{
        .name = "direct_light.comp", .defines = estimator.defines, .named_includes = named_includes(estimator)};
    std::vector<LightAnswer> samples(count);
    run_shader(shader, count, std::as_writable_bytes(std::span(samples)), std::as_bytes(std::span(&inputs, 1)));
    return samples;
}

// Barycentric coordinates w_1 and w_2 of a point in the light's plane.
dvec2 barycentrics_of(const dvec3& point) {
    const dvec3 origin(light_corners[0]), u = dvec3(light_corners[1]) - origin, v = dvec3(light_corners[2]) - origin,
                                          normal = glm::cross(u, v);
    const double area = glm::dot(normal, normal);
    return {glm::dot(normal, glm::cross(point - origin, v)) / area, glm::dot(normal, glm::cross(u, point - origin)) / area};
}

class LightPoints : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Chapters, LightPoints, testing::ValuesIn(chapters_that(samples_lights)), chapter_name);

TEST_P(LightPoints, PointsAreUniformOnTheTriangle) {
    // Cells of equal area: rows between lines of equal w_0, each with the two kinds of triangles of a regular grid.
    constexpr size_t rows = 16;
    std::vector<uint64_t> counts(rows * rows);
    std::vector<double> w_1, w_2, products, squares;
    for (const LightAnswer& sample : sample_light(GetParam(), light_corners, 1'100'000)) {
        ASSERT_EQ(sample.shadow_rays, 1u);
        const dvec2 w = barycentrics_of(dvec3(sample.origin) + dvec3(sample.to_light));
        // Rounding may push points at an edge 10^-6 beyond it.
        ASSERT_GT(w.x, -1e-6);
        ASSERT_GT(w.y, -1e-6);
        ASSERT_LT(w.x + w.y, 1 + 1e-6);
        const dvec2 cell = glm::clamp(w * double{rows}, 0.0, rows - 1e-9);
        const auto column = static_cast<size_t>(cell.x);
        const auto row = std::min(static_cast<size_t>(cell.y), rows - 1 - column);
        const bool is_upper = cell.x - double(column) + cell.y - double(row) > 1 && column + row + 2 <= rows;
        // Cells in a column: rows - column upright ones and one fewer inverted.
        const size_t first = column * (2 * rows - column);
        ++counts[first + 2 * row + is_upper];
        w_1.push_back(w.x);
        w_2.push_back(w.y);
        products.push_back(w.x * w.y);
        squares.push_back(w.x * w.x);
    }
    expect_distribution("cells", counts, std::vector<double>(counts.size(), 1.0 / (rows * rows)), 0.02);
    expect_mean("mean of w_1", estimate_mean(w_1), 1.0 / 3, 0.005);
    expect_mean("mean of w_2", estimate_mean(w_2), 1.0 / 3, 0.005);
    expect_mean("mean of w_1 w_2", estimate_mean(products), 1.0 / 12, 0.01);
    expect_mean("mean of w_1²", estimate_mean(squares), 1.0 / 6, 0.01);
}

TEST_P(LightPoints, WeightIsThatOfTheArea) {
    // L_e ρ cos θ cos θ' / r² A/P for every sample, in multiple importance sampling times p_l / (p_l + p_b), the balance
    // heuristic with the densities p_l = r² / cos θ' P/A of this sample and p_b = cos θ / π of the bounce; with --strategy light
    // there is no such bounce.
    const bool has_strategies = load_chapter(GetParam()).strategies.front() == Strategy::both;
    const dvec3 normal = glm::normalize(
        glm::cross(dvec3(light_corners[1]) - dvec3(light_corners[0]), dvec3(light_corners[2]) - dvec3(light_corners[0])));
    for (const bool only_light_samples : {false, true}) {
        if (only_light_samples && !has_strategies) continue;
        const bool is_weighted = has_strategies && !only_light_samples;
        double worst = 0;
        for (const LightAnswer& sample : sample_light(GetParam(), light_corners, 100'000, only_light_samples)) {
            const dvec3 to_light(sample.to_light), omega = glm::normalize(to_light);
            const double cos_theta = glm::dot(dvec3(surface_normal), omega);
            const double inverse_light_density = glm::dot(normal, -omega) / glm::dot(to_light, to_light) * inverse_density;
            const double weight = is_weighted ? 1 / (1 + cos_theta / pi * inverse_light_density) : 1.0;
            const double expected = emission * albedo / pi * cos_theta * inverse_light_density * weight;
            worst = std::max(worst, std::abs(sample.radiance / expected - 1));
        }
        std::printf("  largest relative error of a weight %.2g\n", worst);
        EXPECT_LT(worst, 1e-5) << (only_light_samples ? "with --strategy light" : "");
    }
}

TEST_P(LightPoints, BacksAndLightsBelowTheHorizonGiveNothing) {
    const auto turned = std::array{light_corners[0], light_corners[2], light_corners[1]};
    std::array<vec3, 3> below = light_corners;
    for (vec3& corner : below) corner.z = -corner.z;
    const auto below_turned = std::array{below[0], below[2], below[1]};
    for (const auto& corners : {turned, below, below_turned})
        for (const LightAnswer& sample : sample_light(GetParam(), corners, 10'000)) {
            ASSERT_EQ(sample.radiance, 0);
            ASSERT_EQ(sample.shadow_rays, 0u);  // none deserves a ray
        }
}

}  // namespace
}  // namespace lab
