// Hypothesis tests and the smallest errors that they detect: what tests need in addition to statistics/statistics.h.
#pragma once
#include <cstdint>
#include <vector>

#include "statistics/statistics.h"

namespace lab {

// Difference of the means of two independent series (Welch).
Difference difference_of(std::span<const double> first, std::span<const double> second);

// Smallest bias that a two-sided test of a normally distributed estimate finds with probability `power`.
double smallest_detectable_bias(double standard_error, double significance, double power);

// Probability that a chi-square variable with the given degrees of freedom (> 0) exceeds x >= 0. Regularised
// incomplete gamma function by series and continued fraction; relative error below 1e-9 up to 10^5 degrees.
double chi_square_p_value(double x, double degrees_of_freedom);

struct ChiSquareTest {
    double statistic = 0;
    double degrees_of_freedom = 0;
    double p_value = 0;  // near 0: a poor fit; near 1: too good, as with dependent samples
    // Weighted root mean square of the relative error of the cells' probabilities that a test of this significance finds with
    // this power, by the noncentral chi-square distribution.
    double smallest_detectable_error(double significance, double power) const;
    double sample_count = 0;
};
// Pearson's goodness-of-fit test. `probabilities` sum to 1. Cells with fewer than five expected samples are pooled; a sample in a
// cell of probability 0 makes the p-value 0.
ChiSquareTest chi_square_test(std::span<const uint64_t> counts, std::span<const double> probabilities);

// Kolmogorov-Smirnov test of independent numbers against the uniform distribution on [0,1]: the p-value by Stephens'
// approximation, accurate to some percent for p < 0.2 and at least 5 numbers.
double kolmogorov_smirnov_p_value(std::vector<double> numbers);
// Distance of the true distribution function from the uniform one that this test of `count` numbers finds with at least the
// probability `power`.
double kolmogorov_smirnov_detectable_distance(size_t count, double significance, double power);

// Pearson's correlation coefficient of two series of equal length, in [-1,1]. For independent series of n numbers its standard
// deviation is 1/sqrt(n).
double correlation(std::span<const float> first, std::span<const float> second);

}  // namespace lab
