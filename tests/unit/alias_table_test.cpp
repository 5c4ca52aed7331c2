// The probabilities of the alias table, recomputed from its integers, and the light table built with it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <random>
#include <string>

#include "scene/light_table.h"
#include "test_files.h"

namespace lab {
namespace {

constexpr long double quantum = 1 / 4294967296.0L;  // 2^-32, the resolution of thresholds

// The probability of each item. Entries are equally probable, as shaders choose them with 64 bits; only sums are rounded.
template <typename Entry>
std::vector<long double> probabilities_of(const std::vector<Entry>& entries) {
    std::vector<long double> probabilities(entries.size());
    for (size_t i = 0; i < entries.size(); ++i) {
        const auto count = static_cast<long double>(entries.size());
        const auto threshold = static_cast<long double>(entries[i].threshold);
        probabilities[i] += threshold * quantum / count;
        probabilities[entries[i].alias] += (1 - threshold * quantum) / count;
    }
    return probabilities;
}

// Weights of several kinds; the random ones span 24 orders of magnitude and include zeros.
struct WeightKind {
    const char* name;
    double (*weight)(size_t i, size_t n, std::mt19937_64& random);
};
double log_uniform(std::mt19937_64& random) { return std::pow(10, std::uniform_real_distribution<>(-12, 12)(random)); }
const WeightKind weight_kinds[] = {
    {"equal", [](size_t, size_t, std::mt19937_64&) { return 0.1; }},
    {"random", [](size_t, size_t, std::mt19937_64& random) { return log_uniform(random); }},
    {"random with zeros",
     [](size_t i, size_t, std::mt19937_64& random) {
         const double weight = log_uniform(random);
         return i % 3 == 1 ? 0.0 : weight;
     }},
    {"only the last is positive", [](size_t i, size_t n, std::mt19937_64&) { return i + 1 == n ? 1e-12 : 0.0; }},
    {"the first is heavy", [](size_t i, size_t, std::mt19937_64&) { return i == 0 ? 1e12 : 1e-12; }},
    {"rising", [](size_t i, size_t, std::mt19937_64&) { return static_cast<double>(i); }},
    {"close to equal", [](size_t i, size_t, std::mt19937_64&) { return i % 2 == 0 ? 1.0 : 1 + 1e-9; }},
    {"whose sum exceeds the range of double", [](size_t i, size_t, std::mt19937_64&) { return i % 2 == 0 ? 1.5e308 : 1e308; }},
};

TEST(AliasTable, HasTheProbabilitiesOfItsWeights) {
    long double worst = 0;
    for (const auto& [name, weight] : weight_kinds)
        for (const size_t n : {size_t{1}, size_t{2}, size_t{3}, size_t{7}, size_t{1000}, size_t{1000000}}) {
            std::mt19937_64 random(n);
            std::vector<double> weights(n);
            for (size_t i = 0; i < n; ++i) weights[i] = weight(i, n, random);
            const double largest = *std::max_element(weights.begin(), weights.end());
            if (largest == 0) continue;
            const AliasTable table = build_alias_table(weights);
            ASSERT_EQ(table.entries.size(), n);
            const auto probabilities = probabilities_of(table.entries);

            long double sum_of_weights = 0, sum = 0, largest_error = 0;
            for (const double w : weights) sum_of_weights += static_cast<long double>(w / largest);
            for (size_t i = 0; i < n; ++i) {
                const long double expected = static_cast<long double>(weights[i] / largest) / sum_of_weights;
                const long double error = std::abs(probabilities[i] - expected);
                ASSERT_EQ(probabilities[i] > 0, weights[i] > 0) << name << ", item " << i << " of " << n;
                // A threshold is off by less than one; over many entries these errors cancel.
                ASSERT_LE(error, 8 * quantum) << name << ", item " << i << " of " << n;
                ASSERT_NEAR(table.probabilities[i] / static_cast<double>(probabilities[i] + (expected == 0)),
                            expected == 0 ? 0 : 1, 1e-11);
                sum += probabilities[i];
                largest_error = std::max(largest_error, error);
            }
            EXPECT_NEAR(static_cast<double>(sum), 1, 1e-12);
            std::printf("  %zu weights, %s: largest error of a probability %.2g quanta of 2^-32\n", n, name,
                        static_cast<double>(largest_error / quantum));
            worst = std::max(worst, largest_error);
        }
    char text[80];
    std::snprintf(text, sizeof text, "%.1e with up to 1e6 weights", static_cast<double>(worst));
    RecordProperty("largest_error_of_a_probability", text);
}

// Triangles (0,0,0), (size,0,0), (0,2,0) in a row, each with its own material.
Scene make_lights(const std::vector<float>& sizes, const std::vector<vec3>& emissions) {
    Scene scene;
    for (uint32_t i = 0; i < sizes.size(); ++i) {
        const vec3 corner(10.0f * static_cast<float>(i), 0, 0);
        scene.positions.insert(scene.positions.end(), {corner, corner + vec3(sizes[i], 0, 0), corner + vec3(0, 2, 0)});
        scene.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
        scene.triangle_materials.push_back(i);
        scene.materials.emplace_back().emission = emissions[i];
    }
    scene.meshes = {{"lights", 0, static_cast<uint32_t>(sizes.size())}};
    return scene;
}

void add_instance(Scene& scene, const mat4x3& object_to_world) {
    scene.instances.push_back({.object_to_world = object_to_world, .normal_to_world = mat3(1)});
    scene.instance_meshes.push_back(0);
}

// The probability of light i in the table times its inverse density, which must be its area.
double area_in_table(const std::vector<LightTriangle>& lights, size_t i) {
    return static_cast<double>(probabilities_of(lights)[i] * lights[i].inverse_density);
}

TEST(LightTable, ChoosesByAreaTimesLuminance) {
    const Scene lights_of_one_mesh = make_lights({1, 3, 1, 2, 0.5f}, {{1, 1, 1}, {0, 0, 0}, {0, 2, 0}, {4, 0, 1}, {0, 0, 1e-6f}});
    Scene scene = lights_of_one_mesh;
    add_instance(scene, mat4x3(1));
    const auto lights = build_light_table(scene).triangles;
    ASSERT_EQ(lights.size(), 4u);  // without the one that emits nothing
    const std::vector<uint32_t> triangles{0, 2, 3, 4};
    const std::vector<double> areas{1, 1, 2, 0.5}, powers{1, 0.7152 * 2, 2 * (0.2126 * 4 + 0.0722), 0.5 * 0.0722 * double{1e-6f}};
    const double sum = std::accumulate(powers.begin(), powers.end(), 0.0);
    const auto probabilities = probabilities_of(lights);
    for (size_t i = 0; i < lights.size(); ++i) {
        EXPECT_EQ(lights[i].triangle, triangles[i]);
        EXPECT_EQ(lights[i].instance, 0u);
        EXPECT_NEAR(static_cast<double>(probabilities[i]), powers[i] / sum, 1e-9);
        EXPECT_NEAR(area_in_table(lights, i) / areas[i], 1, 1e-7);
    }
}

TEST(LightTable, HasTheAreasOfInstancesInTheWorld) {
    using glm::mat4;
    Scene scene = make_lights({1, 3}, {vec3(1), vec3(2)});
    const mat4 turned = glm::rotate(mat4(1), 1.0f, glm::normalize(vec3(1, 2, -1)));
    add_instance(scene, mat4x3(1));
    add_instance(scene, mat4x3(turned * glm::scale(mat4(1), vec3(3))));
    add_instance(scene, mat4x3(glm::scale(turned, vec3(-2, 0.5f, 7))));
    add_instance(scene, mat4x3(glm::scale(mat4(1), vec3(1e-6f))));
    const double scales[] = {1, 9, 1, 1e-12};
    const auto lights = build_light_table(scene).triangles;
    ASSERT_EQ(lights.size(), 8u);
    const auto probabilities = probabilities_of(lights);
    for (uint32_t i = 0; i < lights.size(); ++i) {
        const double area = (i % 2 == 0 ? 1 : 3) * scales[i / 2];
        EXPECT_EQ(lights[i].instance, i / 2);
        EXPECT_EQ(lights[i].triangle, i % 2);
        EXPECT_NEAR(area_in_table(lights, i) / area, 1, 1e-5) << "light " << i;
        EXPECT_NEAR(static_cast<double>(probabilities[i]), area * (1 + i % 2) / (7 * (1 + 9 + 1 + 1e-12)), 1e-6);
    }
}

TEST(LightTable, NeverChoosesDegenerateTriangles) {
    Scene scene = make_lights({0, 1, 0}, {vec3(1e6f), vec3(1), vec3(1)});
    add_instance(scene, mat4x3(1));
    const auto lights = build_light_table(scene).triangles;
    const auto probabilities = probabilities_of(lights);
    for (size_t i = 0; i < lights.size(); ++i) EXPECT_EQ(probabilities[i], lights[i].triangle == 1 ? 1 : 0) << "light " << i;
}

TEST(LightTable, IsEmptyWithoutLights) {
    Scene scene = make_lights({1, 1}, {vec3(0), vec3(0)});
    add_instance(scene, mat4x3(1));
    EXPECT_TRUE(build_light_table(scene).triangles.empty());
}

// Refuses them by their number, before allocating anything.
TEST(LightTable, RefusesMoreLightsThanItCanHold) {
    Scene scene = make_lights(std::vector<float>(1000, 1), std::vector<vec3>(1000, vec3(1)));
    for (int i = 0; i < (1 << 24) / 1000 + 1; ++i) add_instance(scene, mat4x3(1));
    EXPECT_USER_ERROR(build_light_table(scene), "16778000 emissive triangles");
}

}  // namespace
}  // namespace lab
