// Samplers at every number that the generator can return: the 2^24 multiples of 2^-24 below 1.
#include <cmath>
#include <numbers>

#include "support/bounce.h"
#include "support/device_arithmetic.h"
#include "support/gpu_test.h"
#include "support/hemisphere.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

// Calls `check` with pairs of numbers, a million at a time: every number as the second one, with some first one; and the last
// ones, for which a cosine sample lies along the surface, with a thousand others each.
template <typename Check>
void for_all_numbers(const Check& check) {
    constexpr uint32_t count = 1 << 24, piece = 1 << 20;
    for (uint32_t first = 0; first < count; first += piece) {
        std::vector<std::array<double, 2>> numbers;
        numbers.reserve(piece);
        for (uint32_t i = first; i < first + piece; ++i) numbers.push_back({(i * 10368889u % count) * 0x1p-24, i * 0x1p-24});
        check(numbers);
    }
    std::vector<std::array<double, 2>> last;
    for (uint32_t x = 0; x < 1024; ++x)
        for (uint32_t y = 1; y <= 1024; ++y) last.push_back({x / 1024.0, 1 - y * 0x1p-24});
    check(last);
}

TEST(EveryNumber, MakesACosineSampleAboveTheHorizon) {
    double lowest = 1, worst_length = 0;
    for_all_numbers([&](const auto& numbers) {
        std::vector<vec2> pairs;
        for (const auto& [x, y] : numbers) pairs.emplace_back(x, y);
        for (const vec3& direction : sample_hemisphere(chapter_named("cosine_sampling"), pairs)) {
            lowest = std::min(lowest, double{direction.z});
            worst_length = std::max(worst_length, std::abs(glm::length(dvec3(direction)) - 1));
        }
    });
    record("lowest_cosine", "%.3g", lowest);
    record("largest_error_of_a_length", "%.1e", worst_length);
    EXPECT_GE(lowest, 0.99 * 0x1p-12);
    EXPECT_LT(worst_length, 2 * test_arithmetic().sine + 2 * test_arithmetic().division);
}

TEST(EveryNumber, GivesUniformAnglesABoundedWeight) {
    // π sin θ cos θ is at most π/2, even where the density 1/(π² sin θ) is infinite.
    const Surface surface{{0, 0, 1}, {0, 0, 1}, white_material()};
    double largest = 0, worst = 0;
    for_all_numbers([&](const auto& numbers) {
        const auto bounces = bounces_at(chapter_named("uniform_sampling"), surface, numbers);
        for (size_t i = 0; i < numbers.size(); ++i) {
            const double exact = pi / 2 * std::sin(pi * numbers[i][1]);
            ASSERT_GE(bounces[i].weight, 0.0f);
            largest = std::max(largest, double{bounces[i].weight});
            worst = std::max(worst, std::abs(bounces[i].weight - exact));
        }
    });
    record("largest_error_of_a_weight", "%.1e", worst);
    record("largest_weight_over_half_pi", "1 + %.1e", largest / (pi / 2) - 1);
    EXPECT_LT(worst, 2 * pi * test_arithmetic().sine + 1e-6);
    EXPECT_LT(largest, pi / 2 * (1 + 4 * test_arithmetic().sine + 1e-6));
}

}  // namespace
}  // namespace lab
