#include "statistics/statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lab {
namespace {

// Wallace's transformation of Student's t with ν degrees of freedom to a standard normal variable of equal p-value (Annals of
// Mathematical Statistics 30(4), 1959), and its inverse. z is accurate to 0.01 for ν > 20, and closer to 0 than it should be for
// all ν.
double wallace_factor(double degrees_of_freedom) { return (8 * degrees_of_freedom + 1) / (8 * degrees_of_freedom + 3); }
double normal_of_student(double t, double degrees_of_freedom) {
    return wallace_factor(degrees_of_freedom) * std::sqrt(degrees_of_freedom * std::log1p(t * t / degrees_of_freedom));
}
double student_of_normal(double z, double degrees_of_freedom) {
    const double scaled = z / wallace_factor(degrees_of_freedom);
    return std::sqrt(degrees_of_freedom * std::expm1(scaled * scaled / degrees_of_freedom));
}

}  // namespace

double normal_p_value(double z) { return std::erfc(std::abs(z) / std::numbers::sqrt2); }

double normal_quantile(double probability) {
    if (probability > 0.5) return -normal_quantile(1 - probability);
    // Newton's method. The lower tail is convex, so from the second step on it approaches the root from above.
    double z = -std::sqrt(-2 * std::log(probability));
    for (int step = 0; step < 60; ++step) {
        const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
        const double change = (0.5 * std::erfc(-z / std::numbers::sqrt2) - probability) / density;
        z -= change;
        if (std::abs(change) < 1e-14) break;
    }
    return z;
}

double sidak(double significance, size_t count) { return -std::expm1(std::log1p(-significance) / static_cast<double>(count)); }

MeanEstimate estimate_mean(std::span<const double> numbers) {
    const double count = static_cast<double>(numbers.size());
    MeanEstimate estimate;
    for (const double number : numbers) estimate.mean += number / count;
    for (const double number : numbers) estimate.variance += (number - estimate.mean) * (number - estimate.mean) / (count - 1);
    estimate.standard_error = std::sqrt(estimate.variance / count);
    return estimate;
}

double Difference::z() const {
    if (value == 0) return 0;
    return std::copysign(normal_of_student(value / standard_error, degrees_of_freedom), value);
}

double Difference::p_value() const { return normal_p_value(z()); }

double Difference::smallest_detectable(double level, double power) const {
    // From the noncentral t-distribution: near the critical value t the variance of the statistic is 1 + t²/(2ν).
    const double t = student_of_normal(normal_quantile(0.5 * level), degrees_of_freedom);
    return standard_error * (t + normal_quantile(power) * std::sqrt(1 + 0.5 * t * t / degrees_of_freedom));
}

Difference Difference::relative_to(double scale) const { return {value / scale, standard_error / scale, degrees_of_freedom}; }

Difference difference_from(std::span<const double> numbers, double expected) {
    const MeanEstimate estimate = estimate_mean(numbers);
    const double rounding = rounding_error * std::abs(expected);
    return {estimate.mean - expected, std::max(estimate.standard_error, rounding), static_cast<double>(numbers.size() - 1)};
}

}  // namespace lab
