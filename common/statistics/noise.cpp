#include "statistics/noise.h"

#include <algorithm>
#include <cmath>

namespace lab {

NoiseEstimate estimate_noise(const FilmImage& earlier, const FilmImage& later, glm::uvec2 corner,
                             glm::uvec2 size) {
    NoiseEstimate estimate;
    double variance = 0;
    const glm::uvec2 end = glm::min(corner + size, glm::uvec2(later.width, later.height));
    const double pixels = std::max((end.x - corner.x) * (end.y - corner.y), 1u);
    for (uint32_t y = corner.y; y < end.y; ++y)
        for (uint32_t x = corner.x; x < end.x; ++x) {
            const size_t i = size_t{y} * later.width + x;
            const FilmPixel& whole = later.pixels[i];
            if (whole.sample_count == 0) continue;
            const double count = whole.sample_count;
            const double first = earlier.pixels.empty() ? 0 : earlier.pixels[i].sample_count,
                         second = count - first;
            estimate.samples += count / pixels;
            estimate.invalid_samples += whole.invalid_count;
            const glm::dvec3 sum = sum_of(whole);
            estimate.mean += sum / count / pixels;
            if (first == 0 || second == 0) continue;
            const glm::dvec3 sum_of_first = sum_of(earlier.pixels[i]);
            const glm::dvec3 difference = sum_of_first / first - (sum - sum_of_first) / second;
            // Its expected square is the variance of a sample times 1/first + 1/second.
            variance += glm::dot(difference, difference) / (1 / first + 1 / second) / count / (3 * pixels);
        }
    estimate.standard_error = std::sqrt(variance);
    const double mean = (estimate.mean[0] + estimate.mean[1] + estimate.mean[2]) / 3;
    estimate.relative_error = mean > 0 ? estimate.standard_error / mean : 0;
    return estimate;
}

}  // namespace lab
