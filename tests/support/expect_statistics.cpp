#include "support/expect_statistics.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "support/gpu_test.h"

namespace lab {

// Appends a p-value to the file named by LAB_TEST_P_VALUES, for ./lab notebook false_alarms.
static void record_p_value(const std::string& what, double p_value) {
    const char* file = std::getenv("LAB_TEST_P_VALUES");
    if (!file) return;
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::ofstream(file, std::ios::app) << test->test_suite_name() << '.' << test->name() << '\t' << what << '\t' << p_value
                                       << '\n';
}

// Adds the largest error that may go unnoticed to the test's report.
static void record_smallest_error(double error) {
    static const testing::TestInfo* test = nullptr;
    static double largest = 0;
    const testing::TestInfo* current = testing::UnitTest::GetInstance()->current_test_info();
    largest = test == current ? std::max(largest, error) : error;
    test = current;
    record("errors_found_from", "%.2g %%", 100 * largest);
}

// Numbers that fit better than all but this fraction of independent ones are not independent.
static constexpr double too_good = 1 - 1e-9;

// Whether a test that passed could have failed: its fault, unless it tries a student's shader. Of a wrong shader it says nothing.
static void expect_power(const std::string& what, bool has_passed, double finds, double largest) {
    if (!has_passed) return;
    const bool is_copy = std::getenv("LAB_TEST_COPY") != nullptr;
    EXPECT_LT(finds, largest) << what << ": "
                              << (is_copy ? "nothing wrong was found, but the shader is too noisy to tell"
                                          : "the test is too weak, take more samples");
}

void expect_no_difference(const std::string& what, std::span<const Difference> relative_differences, double largest_difference,
                          size_t comparisons) {
    const double level = sidak(significance, relative_differences.size() * comparisons);
    Difference worst;
    double smallest_p_value = 1, weakest = 0;
    for (const Difference& difference : relative_differences) {
        weakest = std::max(weakest, difference.smallest_detectable(level, power));
        const double p_value = difference.p_value();
        if (p_value > smallest_p_value) continue;
        smallest_p_value = p_value;
        worst = difference;
    }
    // Only the first: the p-values of the others depend on it.
    if (relative_differences.front().standard_error > 2 * rounding_error)
        record_p_value(what, relative_differences.front().p_value());
    std::printf("  %s: smallest p of %zu = %.2g, there %+.3f %%; finds a bias of %.3f %%\n", what.c_str(),
                relative_differences.size(), smallest_p_value, 100 * worst.value, 100 * weakest);
    record_smallest_error(weakest);
    EXPECT_GT(smallest_p_value, level) << what << " is off by " << 100 * worst.value << " %";
    expect_power(what, smallest_p_value > level, weakest, largest_difference);
}

void expect_mean(const std::string& what, const MeanEstimate& estimate, double expected, double largest_relative_bias,
                 size_t comparisons) {
    const double level = sidak(significance, comparisons);
    const double bias = smallest_detectable_bias(estimate.standard_error, level, power) / std::abs(expected);
    const double rounding = rounding_error * std::abs(expected);
    const double z = (estimate.mean - expected) / std::max(estimate.standard_error, rounding);
    const double p_value = normal_p_value(z);
    if (estimate.standard_error > 2 * rounding) record_p_value(what, p_value);
    std::printf("  %s: %.6f, expected %.6f, p = %.2g; finds a bias of %.3f %%\n", what.c_str(), estimate.mean, expected, p_value,
                100 * bias);
    record_smallest_error(bias);
    EXPECT_GT(p_value, level) << what << " is biased by " << 100 * (estimate.mean / expected - 1) << " %";
    expect_power(what, p_value > level, bias, largest_relative_bias);
}

void expect_distribution(const std::string& what, std::span<const uint64_t> counts, std::span<const double> probabilities,
                         double largest_error) {
    const ChiSquareTest test = chi_square_test(counts, probabilities);
    const double error = test.smallest_detectable_error(significance, power);
    record_p_value(what, test.p_value);
    std::printf(
        "  %s: chi-square %.1f at %.0f degrees of freedom, p = %.2g; finds an error of the density of %.2f "
        "%%\n",
        what.c_str(), test.statistic, test.degrees_of_freedom, test.p_value, 100 * error);
    record_smallest_error(error);
    EXPECT_GT(test.p_value, significance) << what << " does not follow its density";
    EXPECT_LT(test.p_value, too_good) << what << " fits too well: its samples are not independent";
    expect_power(what, test.p_value > significance, error, largest_error);
}

void expect_uniform(const std::string& what, const std::vector<double>& numbers, double largest_distance) {
    const double p_value = kolmogorov_smirnov_p_value(numbers);
    record_p_value(what, p_value);
    const double distance = kolmogorov_smirnov_detectable_distance(numbers.size(), significance, power);
    std::printf("  %s: Kolmogorov-Smirnov p = %.2g; finds a distribution that is off by %.3f %%\n", what.c_str(), p_value,
                100 * distance);
    record_smallest_error(distance);
    EXPECT_GT(p_value, significance) << what << " is not uniform";
    expect_power(what, p_value > significance, distance, largest_distance);
}

}  // namespace lab
