// Statistical expectations. Each prints what was measured and the smallest error that it would have found
// with probability 0.99, and fails the test if that is not small enough: a test that can find nothing proves
// nothing.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "support/hypothesis_tests.h"

namespace lab {

// Probability of a false alarm in each expectation. Seeds are fixed, so a test that is green on a device
// stays so; on a new device a run with its less than 1000 expectations raises a false alarm with a
// probability below 0.001, see docs/numerics.md.
inline constexpr double significance = 1e-6;
inline constexpr double power = 0.99;

// The mean is `expected`, and a bias of `largest_relative_bias` times `expected` would have been found.
// `comparisons` of one test share its significance.
void expect_mean(const std::string& what, const MeanEstimate& estimate, double expected, double largest_relative_bias,
                 size_t comparisons = 1);

// All relative differences are 0, and in each of them `largest_difference` would have been found. They share
// the significance of this test, and with `comparisons` tests like it.
void expect_no_difference(const std::string& what, std::span<const Difference> relative_differences, double largest_difference,
                          size_t comparisons = 1);

// The counts follow the probabilities, and a relative error of the density by `largest_error` (root mean
// square) would have been found.
void expect_distribution(const std::string& what, std::span<const uint64_t> counts, std::span<const double> probabilities,
                         double largest_error);

// The numbers are uniform in [0,1), and a distribution function that is off by `largest_distance` would have
// been found.
void expect_uniform(const std::string& what, const std::vector<double>& numbers, double largest_distance);

}  // namespace lab
