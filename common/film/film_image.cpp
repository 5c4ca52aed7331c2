#include "film/film_image.h"

#include <algorithm>

namespace lab {

uint32_t FilmImage::min_samples() const {
    const auto fewest = std::min_element(
        pixels.begin(), pixels.end(),
        [](const FilmPixel& a, const FilmPixel& b) { return a.sample_count < b.sample_count; });
    return fewest == pixels.end() ? 0 : fewest->sample_count;
}

bool FilmImage::has_equal_sample_counts() const {
    const uint32_t samples = min_samples();
    return std::all_of(pixels.begin(), pixels.end(),
                       [&](const FilmPixel& pixel) { return pixel.sample_count == samples; });
}

uint64_t FilmImage::invalid_samples() const {
    uint64_t count = 0;
    for (const auto& pixel : pixels) count += pixel.invalid_count;
    return count;
}

Image FilmImage::mean() const {
    Image image{width, height, {}};
    image.pixels.reserve(3 * pixels.size());
    for (const auto& pixel : pixels)
        for (int channel = 0; channel < 3; ++channel) {
            const double sum = double{pixel.sum[channel]} + double{pixel.compensation[channel]};
            image.pixels.push_back(static_cast<float>(sum / std::max(pixel.sample_count, 1u)));
        }
    return image;
}

std::array<double, 3> FilmImage::mean_radiance() const {
    std::array<double, 3> mean{};
    for (const auto& pixel : pixels)
        for (int channel = 0; channel < 3; ++channel) {
            const double sum = double{pixel.sum[channel]} + double{pixel.compensation[channel]};
            mean[static_cast<size_t>(channel)] += sum / std::max(pixel.sample_count, 1u);
        }
    for (double& channel : mean) channel /= static_cast<double>(std::max<size_t>(pixels.size(), 1));
    return mean;
}

FilmImage samples_after(const FilmImage& first, const FilmImage& whole) {
    FilmImage rest = whole;
    for (size_t i = 0; i < rest.pixels.size(); ++i) {
        FilmPixel& pixel = rest.pixels[i];
        const FilmPixel& before = first.pixels[i];
        for (int channel = 0; channel < 3; ++channel) {
            pixel.sum[channel] -= before.sum[channel];
            pixel.compensation[channel] -= before.compensation[channel];
        }
        pixel.sample_count -= before.sample_count;
    }
    return rest;
}

}  // namespace lab
