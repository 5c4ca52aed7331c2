#include "support/expect_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace lab {

// Numbers that fit better than all but this share of independent ones do are not independent.
static constexpr double too_good = 1 - 1e-9;

void expect_mean(const std::string& what, const MeanEstimate& estimate, double expected,
                 double largest_relative_bias, size_t comparisons) {
    const double level = sidak(significance, comparisons);
    const double bias = smallest_detectable_bias(estimate.standard_error, level, power) / std::abs(expected);
    // A standard error of 0 is allowed: an estimate without noise has to be exact but for rounding errors.
    const double rounding = 1e-6 * std::abs(expected);
    const double z = (estimate.mean - expected) / std::max(estimate.standard_error, rounding);
    const double p_value = normal_p_value(z);
    std::printf("  %s: %.6f, expected %.6f, p = %.2g; finds a bias of %.3f %%\n", what.c_str(), estimate.mean,
                expected, p_value, 100 * bias);
    EXPECT_GT(p_value, level) << what << " is biased by " << 100 * (estimate.mean / expected - 1) << " %";
    EXPECT_LT(bias, largest_relative_bias) << what << ": the test is too weak, take more samples";
}

void expect_distribution(const std::string& what, std::span<const uint64_t> counts,
                         std::span<const double> probabilities, double largest_error) {
    const ChiSquareTest test = chi_square_test(counts, probabilities);
    const double error = test.smallest_detectable_error(significance, power);
    std::printf(
        "  %s: chi-square %.1f at %.0f degrees of freedom, p = %.2g; finds an error of the density of %.2f "
        "%%\n",
        what.c_str(), test.statistic, test.degrees_of_freedom, test.p_value, 100 * error);
    EXPECT_GT(test.p_value, significance) << what << " does not follow its density";
    EXPECT_LT(test.p_value, too_good) << what << " fits too well: its samples are not independent";
    EXPECT_LT(error, largest_error) << what << ": the test is too weak, take more samples";
}

void expect_uniform(const std::string& what, const std::vector<double>& numbers) {
    const double p_value = kolmogorov_smirnov_p_value(numbers);
    // The distance whose asymptotic p-value is the significance, plus as much as it varies.
    const double count = static_cast<double>(numbers.size());
    const double distance =
        (std::sqrt(-0.5 * std::log(0.5 * significance)) + 0.5 * normal_quantile(power)) / std::sqrt(count);
    std::printf("  %s: Kolmogorov-Smirnov p = %.2g; finds a distribution that is off by %.3f %%\n",
                what.c_str(), p_value, 100 * distance);
    EXPECT_GT(p_value, significance) << what << " is not uniform";
}

}  // namespace lab
