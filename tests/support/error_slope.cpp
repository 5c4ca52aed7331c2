#include "support/error_slope.h"

#include <cmath>
#include <vector>

#include "statistics/statistics.h"

namespace lab {
namespace {

// The logarithm of the mean squared difference of two renders with different seeds, which is twice the variance of a pixel.
// Averages over interleaved groups of pixels: a few bright pixels spoil one group but not all, and the spread gives the standard
// error.
MeanEstimate log_error(const FilmImage& first, const FilmImage& second) {
    constexpr size_t groups = 16;
    std::vector<double> sums(groups);
    for (int channel = 0; channel < 3; ++channel) {
        const auto a = pixel_means(first, channel), b = pixel_means(second, channel);
        // Neighbours belong to different groups; 7 is coprime to the width.
        for (size_t i = 0; i < a.size(); ++i) sums[i * 7 % groups] += std::pow(a[i] - b[i], 2);
    }
    for (double& sum : sums) sum = std::log(sum * groups / (3.0 * static_cast<double>(first.pixels.size())));
    return estimate_mean(sums);
}

}  // namespace

ErrorSlope measure_error_slope(const Scene& scene, RenderSettings settings, uint32_t max_samples) {
    // Least-squares fit of the logarithms of the errors, each weighted by its own variance.
    double weights = 0, x_sum = 0, y_sum = 0, xx_sum = 0, xy_sum = 0;
    ErrorSlope slope{};
    SceneRenderer renderer(scene, settings);
    for (uint32_t samples = 1; samples <= max_samples; samples *= 4) {
        settings.samples = samples;
        ++settings.seed;
        const FilmImage first = renderer.render(settings).film;
        ++settings.seed;
        const MeanEstimate error = log_error(first, renderer.render(settings).film);
        const double x = std::log(samples), y = 0.5 * error.mean;
        const double weight = 1 / std::pow(0.5 * error.standard_error, 2);
        weights += weight;
        x_sum += weight * x;
        y_sum += weight * y;
        xx_sum += weight * x * x;
        xy_sum += weight * x * y;
        slope.variances += " " + std::to_string(std::exp(error.mean) * samples / 2);
    }
    const double spread = xx_sum - x_sum * x_sum / weights;
    slope.value = (xy_sum - x_sum * y_sum / weights) / spread;
    slope.standard_error = 1 / std::sqrt(spread);
    return slope;
}

}  // namespace lab
