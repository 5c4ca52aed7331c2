#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "statistics/error_metrics.h"

namespace lab {
namespace {

TEST(Noise, IsThatOfTheMean) {
    // Samples are 1 with probability 1/4 and 0 otherwise, so their standard deviation is √3/4.
    constexpr uint32_t extent = 64, samples = 63;
    FilmImage film{extent, extent, std::vector<FilmPixel>(extent * extent)};
    std::mt19937 generator(1);
    for (FilmPixel& pixel : film.pixels) {
        pixel.sample_count = samples;
        std::binomial_distribution<uint32_t> of_first((samples + 1) / 2, 0.25), of_second(samples / 2, 0.25);
        for (int channel = 0; channel < 3; ++channel) {
            const auto first = static_cast<float>(of_first(generator)), second = static_cast<float>(of_second(generator));
            pixel.sum[channel] = first + second;
            pixel.difference[channel] = first - second;
        }
    }
    film.pixels[70].invalid_count = 2;
    const NoiseEstimate whole = estimate_noise(film, {0, 0}, {extent, extent});
    EXPECT_NEAR(whole.mean[1], 0.25, 0.01);
    EXPECT_NEAR(whole.standard_error, std::sqrt(3.0 / 16 / samples), 0.001);
    EXPECT_NEAR(whole.relative_error, std::sqrt(3.0 / samples), 0.01);
    EXPECT_NEAR(whole.samples, samples, 1e-9);
    EXPECT_EQ(whole.invalid_samples, 2u);
    EXPECT_EQ(estimate_noise(film, {16, 16}, {8, 8}).invalid_samples, 0u);
    EXPECT_EQ(
        estimate_noise({8, 8, std::vector<FilmPixel>(64, {vec3(1), vec3(0), vec3(1), 1, 0})}, {0, 0}, {8, 8}).standard_error, 0);
}

TEST(ErrorMetrics, DoNotContainTheVarianceOfTheReference) {
    // The squared error is 0.25 everywhere; 0.09 of it is the variance of the reference.
    const Image image{2, 1, {1.5f, 1.5f, 1.5f, 2.5f, 2.5f, 2.5f}}, mean{2, 1, {1, 1, 1, 2, 2, 2}},
        variance{2, 1, std::vector<float>(6, 0.09f)};
    const double weight = 0.5 / (1 + 0.01 * 2.25) + 0.5 / (4 + 0.01 * 2.25);
    const ErrorMetrics without = compare(image, {mean, std::nullopt, {}}), with = compare(image, {mean, variance, {}});
    EXPECT_NEAR(without.mse, 0.25, 1e-9);
    EXPECT_NEAR(without.rel_mse, 0.25 * weight, 1e-9);
    EXPECT_NEAR(with.mse, 0.16, 1e-7);
    EXPECT_NEAR(with.rel_mse, 0.16 * weight, 1e-7);
    EXPECT_NEAR(with.rel_mse_uncorrected, 0.25 * weight, 1e-9);
    EXPECT_NEAR(with.rel_rmse, std::sqrt(with.rel_mse), 1e-12);
}

}  // namespace
}  // namespace lab
