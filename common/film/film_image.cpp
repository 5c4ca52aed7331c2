#include "film/film_image.h"

#include <algorithm>
#include <cmath>

#include "parallel.h"

namespace lab {
namespace {

glm::dvec3 mean_of(const FilmPixel& pixel) { return sum_of(pixel) / static_cast<double>(std::max(pixel.sample_count, 1u)); }

std::array<double, 3> mean_over_pixels(const std::vector<FilmPixel>& pixels, glm::dvec3 (*value_of)(const FilmPixel&)) {
    const auto sum = sum_in_parallel<glm::dvec3>(pixels.size(), [&](size_t begin, size_t end) {
        glm::dvec3 part(0);
        for (size_t i = begin; i < end; ++i) part += value_of(pixels[i]);
        return part;
    });
    const glm::dvec3 mean = sum / static_cast<double>(std::max<size_t>(pixels.size(), 1));
    return {mean.r, mean.g, mean.b};
}

vec3 shown(const vec3& mean) {
    const float sum = mean.r + mean.g + mean.b;
    return sum < 0 ? vec3(0, 0, -sum / 3) : mean;
}

// Sample counts of the two halves.
glm::dvec2 sizes_of_halves(const FilmPixel& pixel) {
    return {pixel.sample_count - pixel.sample_count / 2, pixel.sample_count / 2};
}

}  // namespace

[[gnu::noinline]] float to_float(double number) { return static_cast<float>(number); }

void set_sum(FilmPixel& pixel, const glm::dvec3& sum) {
    for (int channel = 0; channel < 3; ++channel) {
        pixel.sum[channel] = to_float(sum[channel]);
        pixel.compensation[channel] = to_float(sum[channel] - double{pixel.sum[channel]});
    }
}

std::array<glm::dvec3, 2> means_of_halves(const FilmPixel& pixel) {
    if (pixel.sample_count < 2) return {};
    const glm::dvec2 sizes = sizes_of_halves(pixel);
    const glm::dvec3 sum = sum_of(pixel), difference(pixel.difference);
    return {0.5 * (sum + difference) / sizes[0], 0.5 * (sum - difference) / sizes[1]};
}

glm::dvec3 difference_of_halves(const FilmPixel& pixel) {
    const auto [first, second] = means_of_halves(pixel);
    return first - second;
}

glm::dvec3 variance_of_mean(const FilmPixel& pixel) {
    // The expected squared difference is the variance of a sample times 1/n_0 + 1/n_1 = n/(n_0 n_1).
    const glm::dvec2 parts = sizes_of_halves(pixel) / static_cast<double>(std::max(pixel.sample_count, 1u));
    const glm::dvec3 difference = difference_of_halves(pixel);
    return parts[0] * parts[1] * difference * difference;
}

uint32_t FilmImage::min_samples() const {
    std::vector<uint32_t> minima((pixels.size() + pixels_per_piece - 1) / pixels_per_piece, UINT32_MAX);
    in_parallel(pixels.size(), pixels_per_piece, [&](size_t begin, size_t end) {
        uint32_t& minimum = minima[begin / pixels_per_piece];
        for (size_t i = begin; i < end; ++i) minimum = std::min(minimum, pixels[i].sample_count);
    });
    return minima.empty() ? 0 : std::ranges::min(minima);
}

bool FilmImage::exceeds(uint32_t samples) const { return sum(&FilmPixel::sample_count) > uint64_t{samples} * pixels.size(); }

uint64_t FilmImage::sum(uint32_t FilmPixel::*count) const {
    return sum_in_parallel<uint64_t>(pixels.size(), [&](size_t begin, size_t end) {
        uint64_t part = 0;
        for (size_t i = begin; i < end; ++i) part += pixels[i].*count;
        return part;
    });
}

Image FilmImage::mean() const {
    Image image{width, height, std::vector<float>(3 * pixels.size())};
    in_parallel(pixels.size(), pixels_per_piece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const vec3 mean(mean_of(pixels[i]));
            for (int channel = 0; channel < 3; ++channel) image.pixels[3 * i + channel] = mean[channel];
        }
    });
    return image;
}

std::array<double, 3> FilmImage::mean_radiance() const { return mean_over_pixels(pixels, mean_of); }
std::array<double, 3> FilmImage::mean_difference() const { return mean_over_pixels(pixels, difference_of_halves); }

std::string size_text(const uvec2& size) { return std::to_string(size.x) + "x" + std::to_string(size.y); }

Texture to_display(const FilmImage& film, DisplayTransform transform, float exposure) {
    float scale = 1;
    if (transform == DisplayTransform::exposure) scale = std::exp2(exposure);
    if (transform == DisplayTransform::maximum && !film.pixels.empty()) {
        const float largest = std::ranges::max(film.mean().pixels);
        if (largest > 0) scale = 1 / largest;
    }
    Texture result{film.width, film.height, std::vector<uint8_t>(4 * film.pixels.size())};
    in_parallel(film.pixels.size(), 1 << 14, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            uint8_t* pixel = result.pixels.data() + 4 * i;
            pixel[0] = pixel[2] = pixel[3] = 255;
            if (film.pixels[i].invalid_count > 0) continue;
            const vec3 mean = shown(vec3(mean_of(film.pixels[i])));
            for (int channel = 0; channel < 3; ++channel) {
                float value = std::clamp(scale * mean[channel], 0.0f, 1.0f);
                if (transform == DisplayTransform::exposure) value = linear_to_srgb(value);
                pixel[channel] = static_cast<uint8_t>(std::lround(255 * value));
            }
        }
    });
    return result;
}

}  // namespace lab
