#include "film/film_image.h"

#include <algorithm>
#include <cmath>

#include "parallel.h"

namespace lab {
namespace {

constexpr size_t pixels_per_piece = 1 << 16;  // that a thread works on at a time

glm::dvec3 mean_of(const FilmPixel& pixel) { return sum_of(pixel) / static_cast<double>(std::max(pixel.sample_count, 1u)); }

}  // namespace

uint32_t FilmImage::min_samples() const {
    return pixels.empty() ? 0 : std::ranges::min(pixels, {}, &FilmPixel::sample_count).sample_count;
}

bool FilmImage::has_equal_sample_counts() const {
    return std::ranges::all_of(
        pixels, [&](uint32_t count) { return count == pixels.front().sample_count; }, &FilmPixel::sample_count);
}

uint64_t FilmImage::invalid_samples() const {
    return sum_in_parallel<uint64_t>(pixels.size(), [&](size_t begin, size_t end) {
        uint64_t count = 0;
        for (size_t i = begin; i < end; ++i) count += pixels[i].invalid_count;
        return count;
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

std::array<double, 3> FilmImage::mean_radiance() const {
    const auto sum = sum_in_parallel<glm::dvec3>(pixels.size(), [&](size_t begin, size_t end) {
        glm::dvec3 sum_of_means(0);
        for (size_t i = begin; i < end; ++i) sum_of_means += mean_of(pixels[i]);
        return sum_of_means;
    });
    const glm::dvec3 mean = sum / static_cast<double>(std::max<size_t>(pixels.size(), 1));
    return {mean.r, mean.g, mean.b};
}

std::string size_text(const uvec2& size) { return std::to_string(size.x) + "x" + std::to_string(size.y); }

FilmImage samples_after(const FilmImage& first, const FilmImage& whole) {
    FilmImage rest = whole;
    in_parallel(rest.pixels.size(), pixels_per_piece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            FilmPixel& pixel = rest.pixels[i];
            const FilmPixel& before = first.pixels[i];
            pixel.sum -= before.sum;
            pixel.compensation -= before.compensation;
            pixel.sample_count -= before.sample_count;
        }
    });
    return rest;
}

Texture to_display(const FilmImage& film, DisplayTransform transform, float exposure) {
    const Image mean = film.mean();
    float scale = 1;
    if (transform == DisplayTransform::exposure) scale = std::exp2(exposure);
    if (transform == DisplayTransform::maximum && !mean.pixels.empty()) {
        const float largest = *std::max_element(mean.pixels.begin(), mean.pixels.end());
        if (largest > 0) scale = 1 / largest;
    }
    Texture result{film.width, film.height, std::vector<uint8_t>(4 * film.pixels.size())};
    in_parallel(film.pixels.size(), 1 << 14, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            uint8_t* pixel = result.pixels.data() + 4 * i;
            pixel[0] = pixel[2] = pixel[3] = 255;
            if (film.pixels[i].invalid_count > 0) continue;
            for (size_t channel = 0; channel < 3; ++channel) {
                float value = std::clamp(scale * mean.pixels[3 * i + channel], 0.0f, 1.0f);
                if (transform == DisplayTransform::exposure) value = linear_to_srgb(value);
                pixel[channel] = static_cast<uint8_t>(std::lround(255 * value));
            }
        }
    });
    return result;
}

}  // namespace lab
