// Whether an estimate agrees with what it should be, and which error would have been noticed. All sums and tails are computed in
// double.
#pragma once
#include <cstddef>
#include <span>

namespace lab {

// Probability that a standard normal variable is at least as far from 0 as z. Relative error below 1e-13.
double normal_p_value(double z);

// z such that a standard normal variable is below z with the given probability in (0,1). Absolute error below 1e-12 for
// probabilities from 1e-12 to 0.5; above that 1 - probability is only as exact as the argument.
double normal_quantile(double probability);

// Significance for each of `count` independent tests that together raise a false alarm with probability `significance` (Šidák).
double sidak(double significance, size_t count);

// Mean of independent numbers and the standard deviation of that mean. With means of batches as numbers: batch means.
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

    // Two-sided t-test (Student) of a difference of 0. It never rejects more often than its level says. At 12 degrees of freedom
    // it has 0.92 of a level of 1e-6, at 5 degrees 0.65, at 2 degrees 0.16, and more of larger levels.
    double p_value() const;
    // The standard normal number with this sign and p-value: how many standard errors it is off.
    double z() const;
    // Smallest difference that the t-test finds with probability `power`: 0.99 within 0.002 from 2 degrees of freedom on.
    double smallest_detectable(double level, double power) const;
    // All but the degrees of freedom divided by a scale.
    Difference relative_to(double scale) const;
};
// Of the mean of independent numbers from the expected one.
Difference difference_from(std::span<const double> numbers, double expected);

}  // namespace lab
