// Whether an estimate agrees with its expected value, and how large an error would have been noticed. All sums and tail
// probabilities are computed in double.
#pragma once
#include <cstddef>
#include <span>

namespace lab {

// Probability that a standard normal variable is at least as far from 0 as z. Relative error below 1e-13.
double normal_p_value(double z);

// The z below which a standard normal variable lies with the given probability in (0,1). Absolute error below 1e-12 for
// probabilities from 1e-12 to 0.5; above, 1 - probability is only as accurate as the argument.
double normal_quantile(double probability);

// Significance level for each of `count` independent tests that together raise a false alarm with probability `significance`
// (Šidák).
double sidak(double significance, size_t count);

// Mean of independent numbers and the standard error of that mean. For batch means, pass the means of the batches.
struct MeanEstimate {
    double mean = 0;
    double standard_error = 0;
    double variance = 0;  // of a single number, unbiased
};
// Needs at least two numbers.
MeanEstimate estimate_mean(std::span<const double> numbers);

// Relative error that rounding may cause: noise-free estimates must be exact up to this.
inline constexpr double rounding_error = 1e-6;

// How far an estimate is from its expected value, or from another estimate of the same quantity.
struct Difference {
    double value = 0;
    double standard_error = 0;
    double degrees_of_freedom = 0;  // of the standard error, which is itself an estimate

    // Two-sided t-test (Student) of the hypothesis that the difference is 0. It never rejects more often than its level says: of
    // a level of 1e-6, it attains a fraction of 0.92 at 12 degrees of freedom, 0.65 at 5 and 0.16 at 2, and more of larger
    // levels.
    double p_value() const;
    // The standard normal variable with this sign and p-value: by how many standard errors it is off.
    double z() const;
    // Smallest difference that the t-test finds with probability `power`: for 0.99 accurate to 0.002 from 2 degrees of freedom
    // on.
    double smallest_detectable(double level, double power) const;
    // Everything but the degrees of freedom divided by a scale.
    Difference relative_to(double scale) const;
};
// Difference of the mean of independent numbers from the expected value.
Difference difference_from(std::span<const double> numbers, double expected);

}  // namespace lab
