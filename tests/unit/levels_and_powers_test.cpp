// What the tests of statistics.h and hypothesis_tests.h say of themselves, by simulation: they reject what is
// right as often as their level says, and find the smallest error that they state as often as their power
// says.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "support/hypothesis_tests.h"

namespace lab {
namespace {

// Levels are simulated at one that occurs, powers at the level and power of all tests, see
// expect_statistics.h.
constexpr double level = 0.01, significance = 1e-6, power = 0.99;

using Generator = std::mt19937_64;

// The share of the trials in which a test rejects lies between two bounds. Five standard deviations are
// allowed.
void expect_share(const std::string& what, int trials, double lowest, double highest,
                  const std::function<bool(Generator&)>& rejects) {
    Generator generator(1);
    int rejected = 0;
    for (int trial = 0; trial < trials; ++trial) rejected += rejects(generator);
    const double share = static_cast<double>(rejected) / trials;
    const auto noise = [&](double probability) {
        return 5 * std::sqrt(probability * (1 - probability) / trials);
    };
    EXPECT_GE(share, lowest - noise(lowest)) << what;
    EXPECT_LE(share, highest + noise(highest)) << what;
}

std::vector<double> normal_numbers(Generator& generator, size_t count, double mean, double deviation) {
    std::normal_distribution<double> distribution(mean, deviation);
    std::vector<double> numbers(count);
    for (double& number : numbers) number = distribution(generator);
    return numbers;
}

TEST(TTest, HasItsLevelAndItsPower) {
    for (const auto& [freedom, lowest_level] : {std::pair{2, 0.78}, {5, 0.95}, {12, 0.98}, {31, 0.99}}) {
        const auto count = static_cast<size_t>(freedom + 1);
        const auto p_value = [&](Generator& generator, double bias) {
            return difference_from(normal_numbers(generator, count, 10 + bias, 1), 10).p_value();
        };
        const std::string what = std::to_string(freedom) + " degrees of freedom";
        expect_share("level, " + what, 20'000, lowest_level * level, level,
                     [&](Generator& generator) { return p_value(generator, 0) < level; });
        const double bias =
            Difference{0, 1 / std::sqrt(static_cast<double>(count)), 1.0 * freedom}.smallest_detectable(
                significance, power);
        expect_share("power, " + what, 20'000, power, power + 0.002,
                     [&](Generator& generator) { return p_value(generator, bias) < significance; });
    }
}

TEST(TTest, HasItsLevelWhereSimulationsDoNotReach) {
    // Expected values: SciPy's Student distribution. Rejecting too rarely is the safe side.
    for (const auto& [t, freedom, expected, share] : {std::tuple{12.0, 5.0, 7.089492517161522e-05, 1.4},
                                                      {9.0, 12.0, 1.104090140587179e-06, 1.09},
                                                      {6.0, 31.0, 1.2270961952866998e-06, 1.02}}) {
        const double p_value = Difference{t, 1, freedom}.p_value();
        EXPECT_GE(p_value, expected) << freedom;
        EXPECT_LE(p_value, share * expected) << freedom;
    }
}

TEST(WelchTest, HasItsLevelAndItsPower) {
    constexpr size_t first = 12, second = 24;
    for (const auto& [first_deviation, second_deviation] : {std::pair{1.0, 1.0}, {3.0, 1.0}, {1.0, 3.0}}) {
        const auto p_value = [&](Generator& generator, double bias) {
            const auto a = normal_numbers(generator, first, 10 + bias, first_deviation);
            return difference_of(a, normal_numbers(generator, second, 10, second_deviation)).p_value();
        };
        const std::string what =
            "deviations " + std::to_string(first_deviation) + " and " + std::to_string(second_deviation);
        expect_share("level, " + what, 20'000, 0.95 * level, 1.05 * level,
                     [&](Generator& generator) { return p_value(generator, 0) < level; });
        const double a = first_deviation * first_deviation / first,
                     b = second_deviation * second_deviation / second;
        const Difference exact{0, std::sqrt(a + b),
                               (a + b) * (a + b) / (a * a / (first - 1) + b * b / (second - 1))};
        const double bias = exact.smallest_detectable(level, power);
        expect_share("power, " + what, 20'000, power - 0.003, power + 0.003,
                     [&](Generator& generator) { return p_value(generator, bias) < level; });
    }
}

TEST(ChiSquareTest, KnowsTheNoncentralDistribution) {
    // Noncentralities of SciPy. With one degree of freedom it is the test of a normal number.
    ChiSquareTest test;
    test.sample_count = 1;
    for (const auto& [freedom, alpha, beta, expected] : {std::tuple{1.0, 1e-3, 0.99, 31.54928033427846},
                                                         {3.0, 1e-6, 0.99, 59.45873984977192},
                                                         {20.0, 0.05, 0.8, 20.9607918337039},
                                                         {4095.0, 1e-6, 0.99, 684.5399881056857}}) {
        test.degrees_of_freedom = freedom;
        EXPECT_NEAR(test.smallest_detectable_error(alpha, beta), std::sqrt(expected), 1e-7) << freedom;
    }
}

TEST(KolmogorovSmirnov, HasItsLevelAndItsPower) {
    std::uniform_real_distribution<double> uniform;
    // The share `distance` of the numbers lies below 1/2 instead of above.
    const auto p_value = [&](Generator& generator, size_t count, double distance) {
        std::vector<double> numbers(count);
        for (double& number : numbers) {
            number = uniform(generator);
            if (number > 0.5 && number < 0.5 + distance) number -= distance;
        }
        return kolmogorov_smirnov_p_value(numbers);
    };
    for (const size_t count : {5u, 20u, 50u}) {
        expect_share("level of " + std::to_string(count), 10'000, 0.95 * level, 1.05 * level,
                     [&](Generator& generator) { return p_value(generator, count, 0) < level; });
    }
    const double distance = kolmogorov_smirnov_detectable_distance(200, significance, power);
    expect_share("power", 3'000, power, 1,
                 [&](Generator& generator) { return p_value(generator, 200, distance) < significance; });
}

}  // namespace
}  // namespace lab
