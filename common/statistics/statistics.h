// Statistics for tests and reports: whether a render, or a sampler, agrees with what it should be, and which
// error would have been noticed. All sums and tails are computed in double.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace lab {

// Probability that a standard normal variable is at least as far from 0 as z. Relative error below 1e-13.
double normal_p_value(double z);

// z such that a standard normal variable is below z with the given probability in (0,1). Absolute error below
// 1e-12 for probabilities from 1e-12 to 0.5; above that 1 - probability is only as exact as the argument.
double normal_quantile(double probability);

// Probability that a chi-square variable with the given degrees of freedom (> 0) exceeds x >= 0. Regularised
// incomplete gamma function by series and continued fraction; relative error below 1e-9 up to 10^5 degrees.
double chi_square_p_value(double x, double degrees_of_freedom);

// Significance for each of `count` independent tests that together raise a false alarm with probability
// `significance` (Šidák).
double sidak(double significance, size_t count);

// Mean of independent numbers and the standard deviation of that mean. With means of batches as numbers:
// batch means.
struct MeanEstimate {
    double mean = 0;
    double standard_error = 0;
    double variance = 0;  // of a single number, without bias
};
// Needs at least two numbers.
MeanEstimate estimate_mean(std::span<const double> numbers);

// Relative error that rounding may cause: estimates without noise have to be exact but for this.
inline constexpr double rounding_error = 1e-6;

// How far an estimate is from what it should be, or from another estimate of the same number.
struct Difference {
    double value = 0;
    double standard_error = 0;
    double degrees_of_freedom = 0;  // of the standard error, which is itself an estimate

    // Two-sided t-test (Student) of a difference of 0. It never rejects more often than its level says. At 12
    // degrees of freedom it has 0.92 of a level of 1e-6, at 5 degrees 0.65, at 2 degrees 0.16, and more of
    // larger levels.
    double p_value() const;
    // The standard normal number with this sign and p-value: how many standard errors it is off.
    double z() const;
    // Smallest difference that the t-test finds with probability `power`: 0.99 within 0.002 from 2 degrees of
    // freedom on.
    double smallest_detectable(double level, double power) const;
    // All but the degrees of freedom divided by a scale.
    Difference relative_to(double scale) const;
};
// Of the mean of independent numbers from the expected one.
Difference difference_from(std::span<const double> numbers, double expected);
// Of the means of two independent series (Welch).
Difference difference_of(std::span<const double> first, std::span<const double> second);

// Smallest bias that a two-sided test of a normally distributed estimate finds with probability `power`.
double smallest_detectable_bias(double standard_error, double significance, double power);

struct ChiSquareTest {
    double statistic = 0;
    double degrees_of_freedom = 0;
    double p_value = 0;  // near 0: a poor fit; near 1: too good, as of samples that are not independent
    // Root mean square of the relative error of the cells' probabilities, weighted by them, that a test of
    // this significance finds with this power, by the noncentral chi-square distribution.
    double smallest_detectable_error(double significance, double power) const;
    double sample_count = 0;
};
// Pearson's goodness-of-fit test. `probabilities` sum to 1. Cells that expect fewer than five samples are
// pooled; a sample in a cell of probability 0 makes the p-value 0.
ChiSquareTest chi_square_test(std::span<const uint64_t> counts, std::span<const double> probabilities);

// Kolmogorov-Smirnov test of independent numbers against the uniform distribution on [0,1]: the p-value by
// Stephens' approximation, good to some percent for p < 0.2 and 5 or more numbers.
double kolmogorov_smirnov_p_value(std::vector<double> numbers);
// Distance of the true distribution function from the uniform one that this test of `count` numbers finds
// with probability `power` at least.
double kolmogorov_smirnov_detectable_distance(size_t count, double significance, double power);

// Pearson's coefficient of correlation of two series of the same length, in [-1,1]. For independent series of
// n numbers its standard deviation is 1/sqrt(n).
double correlation(std::span<const float> first, std::span<const float> second);

}  // namespace lab
