// Statistical expectations. Each prints what was measured and the smallest error that it would have found with probability 0.99,
// and fails if that is too large: a test that can find nothing proves nothing.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "support/hypothesis_tests.h"

namespace lab {

// Probability of a false alarm in each expectation. Seeds are fixed, so a test that passes on a device keeps passing; on a new
// device, a run with its fewer than 1000 expectations raises a false alarm with probability below 0.001, see docs/numerics.md.
inline constexpr double significance = 1e-6;
inline constexpr double power = 0.99;

// Expects the mean to be `expected`; a bias of `largest_relative_bias` times `expected` would have been found. `comparisons` of
// one test share its significance.
void expect_mean(const std::string& what, const MeanEstimate& estimate, double expected, double largest_relative_bias,
                 size_t comparisons = 1);

// Expects all relative differences to be 0; `largest_difference` would have been found in each of them. They share the
// significance of this test, and with `comparisons` tests like it.
void expect_no_difference(const std::string& what, std::span<const Difference> relative_differences, double largest_difference,
                          size_t comparisons = 1);

// Expects the counts to follow the probabilities; a relative error of the density by `largest_error` (root mean square) would
// have been found.
void expect_distribution(const std::string& what, std::span<const uint64_t> counts, std::span<const double> probabilities,
                         double largest_error);

// Expects the numbers to be uniform in [0,1); a distribution function that is off by `largest_distance` would have been found.
void expect_uniform(const std::string& what, const std::vector<double>& numbers, double largest_distance);

}  // namespace lab
