#include "support/hypothesis_tests.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lab {
namespace {

// Upper regularised incomplete gamma function Q(a, x), from the series of P = 1 - Q where it converges fast and by Lentz's
// continued fraction elsewhere (Press et al., "Numerical Recipes", 6.2).
double upper_gamma(double a, double x) {
    if (x <= 0) return 1;
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const double scale = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double k = a + 1; term > sum * epsilon; ++k) {
            term *= x / k;
            sum += term;
        }
        return 1 - scale * sum;
    }
    double b = x + 1 - a, c = 1 / std::numeric_limits<double>::min(), d = 1 / b, fraction = d, factor = 0;
    for (double k = 1; std::abs(factor - 1) > epsilon; ++k) {
        const double numerator = -k * (k - a);
        b += 2;
        d = 1 / (numerator * d + b);
        c = b + numerator / c;
        factor = d * c;
        fraction *= factor;
    }
    return scale * fraction;
}

// Probability that a noncentral chi-square variable exceeds x > 0: that of central ones with 2j more degrees of freedom, where j
// is Poisson-distributed. Its mean is half the noncentrality, by which the expectation is larger.
double noncentral_chi_square_p_value(double x, double degrees_of_freedom, double noncentrality) {
    const double mean = 0.5 * noncentrality, range = 10 * std::sqrt(mean) + 30;
    double j = std::floor(std::max(mean - range, 0.0)), sum = 0;
    double tail = chi_square_p_value(x, degrees_of_freedom + 2 * j);
    for (; j < mean + range; ++j) {
        sum += std::exp(j * std::log(mean) - mean - std::lgamma(j + 1)) * tail;
        const double a = 0.5 * degrees_of_freedom + j;
        tail += std::exp(a * std::log(0.5 * x) - 0.5 * x - std::lgamma(a + 1));
    }
    return sum;
}

// The x > 0 above which a condition holds, by bisection to a relative error of 1e-9.
template <typename Condition>
double smallest_with(const Condition& holds) {
    double low = 0, high = 1;
    for (; !holds(high); high *= 2) low = high;
    while (high - low > 1e-9 * high) {
        const double middle = 0.5 * (low + high);
        (holds(middle) ? high : low) = middle;
    }
    return high;
}

}  // namespace

Difference difference_of(std::span<const double> first, std::span<const double> second) {
    const MeanEstimate a = estimate_mean(first), b = estimate_mean(second);
    const auto square = [](double x) { return x * x; };
    const double rounding = rounding_error * std::abs(b.mean);
    const double variance_a = square(std::max(a.standard_error, rounding)),
                 variance_b = square(std::max(b.standard_error, rounding));
    const double degrees_of_freedom =
        square(variance_a + variance_b) / (square(variance_a) / static_cast<double>(first.size() - 1) +
                                           square(variance_b) / static_cast<double>(second.size() - 1));
    return {a.mean - b.mean, std::sqrt(variance_a + variance_b), degrees_of_freedom};
}

double smallest_detectable_bias(double standard_error, double significance, double power) {
    return (-normal_quantile(0.5 * significance) + normal_quantile(power)) * standard_error;
}

double chi_square_p_value(double x, double degrees_of_freedom) { return upper_gamma(0.5 * degrees_of_freedom, 0.5 * x); }

ChiSquareTest chi_square_test(std::span<const uint64_t> counts, std::span<const double> probabilities) {
    ChiSquareTest test;
    for (const uint64_t count : counts) test.sample_count += static_cast<double>(count);
    constexpr double smallest_expectation = 5;
    double cells = 0, pooled_count = 0, pooled_expectation = 0;
    const auto add_cell = [&](double count, double expectation) {
        test.statistic += (count - expectation) * (count - expectation) / expectation;
        ++cells;
    };
    for (size_t i = 0; i < counts.size(); ++i) {
        const double count = static_cast<double>(counts[i]), expectation = test.sample_count * probabilities[i];
        if (expectation >= smallest_expectation) {
            add_cell(count, expectation);
        } else {
            pooled_count += count;
            pooled_expectation += expectation;
            if (expectation == 0 && count > 0) test.statistic = std::numeric_limits<double>::infinity();
        }
    }
    if (pooled_expectation > 0) add_cell(pooled_count, pooled_expectation);
    test.degrees_of_freedom = cells - 1;
    test.p_value = std::isfinite(test.statistic) ? chi_square_p_value(test.statistic, test.degrees_of_freedom) : 0;
    return test;
}

double ChiSquareTest::smallest_detectable_error(double significance, double power) const {
    const double critical = smallest_with([&](double x) { return chi_square_p_value(x, degrees_of_freedom) <= significance; });
    const double noncentrality = smallest_with(
        [&](double lambda) { return noncentral_chi_square_p_value(critical, degrees_of_freedom, lambda) >= power; });
    return std::sqrt(noncentrality / sample_count);
}

double kolmogorov_smirnov_p_value(std::vector<double> numbers) {
    std::sort(numbers.begin(), numbers.end());
    const double count = static_cast<double>(numbers.size());
    double distance = 0;
    for (size_t i = 0; i < numbers.size(); ++i) {
        const double below = static_cast<double>(i) / count;
        distance = std::max({distance, numbers[i] - below, below + 1 / count - numbers[i]});
    }
    const double x = (std::sqrt(count) + 0.12 + 0.11 / std::sqrt(count)) * distance;
    if (x < 0.3) return 1;  // 1 - p is below 1e-5, and the series converges slowly
    double sum = 0;
    for (int k = 1; k <= 20; ++k) sum += (k % 2 == 1 ? 2 : -2) * std::exp(-2 * k * k * x * x);
    return std::clamp(sum, 0.0, 1.0);
}

double kolmogorov_smirnov_detectable_distance(size_t count, double significance, double power) {
    // The asymptotic critical distance, plus the standard deviation of a frequency, which is largest at 1/2.
    return (std::sqrt(-0.5 * std::log(0.5 * significance)) + 0.5 * normal_quantile(power)) /
           std::sqrt(static_cast<double>(count));
}

double correlation(std::span<const float> first, std::span<const float> second) {
    const double count = static_cast<double>(first.size());
    double mean_x = 0, mean_y = 0;
    for (size_t i = 0; i < first.size(); ++i) {
        mean_x += first[i] / count;
        mean_y += second[i] / count;
    }
    double xx = 0, yy = 0, xy = 0;
    for (size_t i = 0; i < first.size(); ++i) {
        const double x = first[i] - mean_x, y = second[i] - mean_y;
        xx += x * x;
        yy += y * y;
        xy += x * y;
    }
    return xy / std::sqrt(xx * yy);
}

}  // namespace lab
