// Renders that stop once their error is small enough: as accurate as they claim, and unbiased.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "rendering/render_job.h"
#include "statistics/error_metrics.h"
#include "statistics/statistics.h"

namespace lab {
namespace {

constexpr uint32_t width = 24;  // and height of a picture

// A picture whose samples are 1/p with probability p and 0 otherwise, in all channels, so that its mean is 1. It renders until
// its error is at most `target`.
class Picture {
  public:
    Picture(double p, uint32_t seed) : p_(p), generator_(seed) {}

    void render_until(double target) {
        for (double growth = 2; !error || error->rel_rmse > target; ++looks) {
            advance(next_sample_count(film_.min_samples(), 1u << 20, growth));
            error = estimate_error(film_);
            if (error) growth = std::pow(error->rel_rmse / target, 2);
        }
    }
    double mean() const { return film_.mean_radiance()[0]; }
    double mean_square_error() const {
        double sum = 0;
        for (const FilmPixel& pixel : film_.pixels) sum += std::pow(sum_of(pixel)[0] / pixel.sample_count - 1, 2);
        return sum / static_cast<double>(film_.pixels.size());
    }
    uint32_t samples() const { return film_.min_samples(); }

    std::optional<ErrorMetrics> error;
    uint32_t looks = 0;

  private:
    void advance(uint32_t samples) {
        for (FilmPixel& pixel : film_.pixels) {
            const uint32_t further = samples - pixel.sample_count, odd = (further + pixel.sample_count % 2) / 2;
            const auto second = static_cast<float>(hits(odd) / p_), first = static_cast<float>(hits(further - odd) / p_);
            pixel.sum += vec3(first + second);
            pixel.difference += vec3(first - second);
            pixel.sample_count = samples;
        }
    }
    double hits(uint32_t samples) { return std::binomial_distribution<uint32_t>(samples, p_)(generator_); }

    double p_;
    std::mt19937 generator_;
    FilmImage film_{width, width, std::vector<FilmPixel>(width* width)};
};

TEST(Stopping, NeitherBiasesThePictureNorItsError) {
    // The smaller the picture and the rarer the light, the more its stopping depends on chance.
    constexpr double p = 1.0 / 64, target = 0.5;
    constexpr uint32_t pictures = 1500;
    std::vector<double> means, squares, reported, needed;
    double looks = 0, within = 0;
    for (uint32_t seed = 0; seed < pictures; ++seed) {
        Picture picture(p, seed);
        picture.render_until(target);
        means.push_back(picture.mean());
        squares.push_back(picture.mean_square_error());
        reported.push_back(picture.error->mse);
        needed.push_back(picture.samples());
        looks += static_cast<double>(picture.looks) / pictures;
        within += (std::abs(picture.mean() - 1) < 1.96 * std::sqrt(picture.error->mse / (width * width))) * 1.0 / pictures;
    }
    const MeanEstimate mean = estimate_mean(means);
    const double bias = (mean.mean - 1) / std::sqrt(mean.variance), uncertainty = 1 / std::sqrt(static_cast<double>(pictures));
    const double ratio = std::sqrt(estimate_mean(squares).mean / estimate_mean(reported).mean);
    const double fewest = (1 / p - 1) / (target * target);  // number of samples that the target takes
    std::printf(
        "  bias %+.3f ± %.3f standard deviations, actual over reported error %.3f, %.1f %% within the error bar,\n"
        "  samples x %.2f, %.1f looks\n",
        bias, uncertainty, ratio, 100 * within, estimate_mean(needed).mean / fewest, looks);
    EXPECT_LT(std::abs(bias) + 2 * uncertainty, 0.15);
    EXPECT_NEAR(ratio, 1, 0.03);
    EXPECT_GT(within, 0.93);
    EXPECT_LT(within, 0.97);
    EXPECT_LT(estimate_mean(needed).mean, 1.15 * fewest);
    EXPECT_LT(looks, 12);
}

// Of a derivative, which may be negative: relative to its size, whatever its sign.
TEST(Stopping, HasNoSign) {
    FilmImage film{16, 16, {}};
    for (uint32_t i = 0; i < 256; ++i) film.pixels.push_back({vec3(i < 128 ? 1.0f : 3.0f), vec3(0), vec3(0.5f), 16, 0});
    const double expected = estimate_error(film)->rel_mse;
    for (FilmPixel& pixel : film.pixels) pixel.sum *= -1.0f;
    EXPECT_EQ(estimate_error(film)->rel_mse, expected);
    for (size_t i = 0; i < 128; ++i) film.pixels[i].sum *= -1.0f;
    EXPECT_EQ(estimate_error(film)->rel_mse, expected);
}

}  // namespace
}  // namespace lab
