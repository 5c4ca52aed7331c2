#include <gtest/gtest.h>

#include <cmath>

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

// Tests compare float with double results. Without the flag that tests/CMakeLists.txt sets, GCC 12 drops this
// rounding.
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

}  // namespace
}  // namespace lab
