// The hypothesis tests that other tests rely on: their values against mpmath and SciPy; and if they are approximations, by
// simulation, that they reject the truth no more often than their level says and find the smallest error that they state.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "support/hypothesis_tests.h"

namespace lab {
namespace {

void expect_relative(double value, double expected, double tolerance) {
    EXPECT_NEAR(value, expected, tolerance * std::abs(expected));
}

[[gnu::noinline]] void round_to_float(double* pair) {
    const float first = static_cast<float>(pair[0]), second = static_cast<float>(pair[1]);
    pair[0] = first;
    pair[1] = second;
}

// Tests compare float with double results. Without the flag set in tests/CMakeLists.txt, GCC 12 optimises this rounding away.
TEST(Compiler, RoundsToFloatAndBack) {
    volatile const double number = 0.1;  // unknown to the compiler
    double pair[] = {number, number};
    round_to_float(pair);
    EXPECT_EQ(pair[0], double{0.1f});
    EXPECT_EQ(pair[1], double{0.1f});
}

// Expected values: mpmath with 40 digits.
TEST(Normal, PValue) {
    EXPECT_EQ(normal_p_value(0), 1);
    expect_relative(normal_p_value(1.959963984540054), 0.05, 1e-13);
    expect_relative(normal_p_value(-5), 5.7330314375838782e-7, 1e-13);
    expect_relative(normal_p_value(10), 1.5239706048321052e-23, 1e-13);
}

TEST(Normal, Quantile) {
    EXPECT_NEAR(normal_quantile(1e-12), -7.0344838253011319, 1e-12);
    EXPECT_NEAR(normal_quantile(1e-5), -4.2648907939228246, 1e-12);
    EXPECT_NEAR(normal_quantile(0.025), -1.9599639845400542, 1e-12);
    EXPECT_NEAR(normal_quantile(0.3), -0.52440051270804078, 1e-12);
    EXPECT_NEAR(normal_quantile(0.5), 0, 1e-12);
    EXPECT_NEAR(normal_quantile(0.99), 2.3263478740408411, 1e-12);
}

TEST(ChiSquare, PValue) {
    expect_relative(chi_square_p_value(3.841458820694124, 1), 0.05, 1e-9);
    expect_relative(chi_square_p_value(10, 3), 0.018566135463043233, 1e-9);
    expect_relative(chi_square_p_value(0.5, 2), 0.77880078307140487, 1e-9);
    expect_relative(chi_square_p_value(43.8, 19), 0.0010064417861340712, 1e-9);
    expect_relative(chi_square_p_value(5202, 5201), 0.49348126705806647, 1e-9);
    expect_relative(chi_square_p_value(5700, 5201), 1.0127948682022023e-6, 1e-9);
    expect_relative(chi_square_p_value(4800, 5201), 0.99997223245273604, 1e-9);
    expect_relative(chi_square_p_value(101000, 100000), 0.01286884037723367, 1e-9);
    EXPECT_EQ(chi_square_p_value(0, 7), 1);
}

TEST(ChiSquare, PoolsRareCellsAndRefusesImpossibleOnes) {
    // Expects 50, 46, 2 and 2 samples: the last two are pooled to 4.
    const std::vector<double> probabilities{0.5, 0.46, 0.02, 0.02};
    const auto pooled = chi_square_test(std::vector<uint64_t>{40, 54, 6, 0}, probabilities);
    EXPECT_EQ(pooled.degrees_of_freedom, 2);
    EXPECT_NEAR(pooled.statistic, 100.0 / 50 + 64.0 / 46 + 4.0 / 4, 1e-12);
    EXPECT_EQ(chi_square_test(std::vector<uint64_t>{99, 1}, std::vector<double>{1, 0}).p_value, 0);
}

TEST(KolmogorovSmirnov, CriticalValues) {
    // Tabulated for 20 numbers: a distance of 0.29408 has p = 0.05, one of 0.35241 has p = 0.01.
    for (const auto& [distance, p_value] : {std::pair{0.29408, 0.05}, std::pair{0.35241, 0.01}}) {
        std::vector<double> numbers;
        for (int i = 0; i < 20; ++i) numbers.push_back(std::max((i + 1) / 20.0 - distance, 0.0));
        expect_relative(kolmogorov_smirnov_p_value(numbers), p_value, 0.03);
    }
    std::vector<double> even;
    for (int i = 0; i < 1000; ++i) even.push_back((i + 0.5) / 1000);
    EXPECT_EQ(kolmogorov_smirnov_p_value(even), 1);
}

TEST(Mean, OfNumbersFarFromZero) {
    const std::vector<double> numbers{1e9 + 1, 1e9 + 2, 1e9 + 3, 1e9 + 4};
    const MeanEstimate estimate = estimate_mean(numbers);
    EXPECT_DOUBLE_EQ(estimate.mean, 1e9 + 2.5);
    EXPECT_NEAR(estimate.variance, 5.0 / 3, 1e-6);
    EXPECT_NEAR(estimate.standard_error, std::sqrt(5.0 / 12), 1e-6);
}

TEST(Significance, SidakAndDetectableBias) {
    EXPECT_NEAR(sidak(0.05, 10), 0.005116196891823743, 1e-15);
    expect_relative(sidak(1e-9, 1000), 1e-12, 1e-6);
    // The rule of thumb for significance 0.001 and power 0.99: (3.2905 + 2.3263) standard errors.
    EXPECT_NEAR(smallest_detectable_bias(2, 0.001, 0.99), 2 * (3.290526731491896 + 2.3263478740408411), 1e-9);
}

TEST(Correlation, OfLinesAndOfOrthogonalSeries) {
    const std::vector<float> rising{1, 2, 3, 4}, falling{8, 6, 4, 2}, symmetric{1, -1, -1, 1};
    EXPECT_NEAR(correlation(rising, rising), 1, 1e-15);
    EXPECT_NEAR(correlation(rising, falling), -1, 1e-15);
    EXPECT_NEAR(correlation(rising, symmetric), 0, 1e-15);
}

// Levels are simulated at one that occurs often, powers at the level and power of all tests, see expect_statistics.h.
constexpr double level = 0.01, significance = 1e-6, power = 0.99;

using Generator = std::mt19937_64;

// Expects the fraction of trials in which a test rejects to lie between two bounds. Allows five standard deviations.
void expect_share(const std::string& what, int trials, double lowest, double highest,
                  const std::function<bool(Generator&)>& rejects) {
    Generator generator(1);
    int rejected = 0;
    for (int trial = 0; trial < trials; ++trial) rejected += rejects(generator);
    const double share = static_cast<double>(rejected) / trials;
    const auto noise = [&](double probability) { return 5 * std::sqrt(probability * (1 - probability) / trials); };
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
            Difference{0, 1 / std::sqrt(static_cast<double>(count)), 1.0 * freedom}.smallest_detectable(significance, power);
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
        const std::string what = "deviations " + std::to_string(first_deviation) + " and " + std::to_string(second_deviation);
        expect_share("level, " + what, 20'000, 0.95 * level, 1.05 * level,
                     [&](Generator& generator) { return p_value(generator, 0) < level; });
        const double a = first_deviation * first_deviation / first, b = second_deviation * second_deviation / second;
        const Difference exact{0, std::sqrt(a + b), (a + b) * (a + b) / (a * a / (first - 1) + b * b / (second - 1))};
        const double bias = exact.smallest_detectable(level, power);
        expect_share("power, " + what, 20'000, power - 0.003, power + 0.003,
                     [&](Generator& generator) { return p_value(generator, bias) < level; });
    }
}

TEST(ChiSquareTest, KnowsTheNoncentralDistribution) {
    // Noncentralities from SciPy. With one degree of freedom it is the test of a normal variable.
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
    // The fraction `distance` of the numbers lies below 1/2 instead of above.
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
