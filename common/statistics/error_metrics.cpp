#include "statistics/error_metrics.h"

#include <algorithm>
#include <cmath>

#include "error.h"
#include "parallel.h"

namespace lab {
namespace {

glm::dvec3 pixel_of(const Image& image, size_t i) {
    return {image.pixels[3 * i], image.pixels[3 * i + 1], image.pixels[3 * i + 2]};
}

// `squared_error(i)` and `variance(i)` of pixel i of the image, by channel, relative to the values of `scale`, of any sign.
template <typename SquaredError, typename Variance>
ErrorMetrics metrics(const Image& scale, const SquaredError& squared_error, const Variance& variance) {
    const size_t size = scale.pixels.size();
    const double count = static_cast<double>(size);
    const double mean = sum_in_parallel<double>(size,
                                                [&](size_t begin, size_t end) {
                                                    double sum = 0;
                                                    for (size_t i = begin; i < end; ++i) sum += std::abs(scale.pixels[i]);
                                                    return sum;
                                                }) /
                        count;
    // Sums of errors and variances, each also relative.
    const auto sums = sum_in_parallel<glm::dvec4>(size / 3, [&](size_t begin, size_t end) {
        const glm::dvec3 one(1);
        glm::dvec4 sum(0);
        for (size_t i = begin; i < end; ++i) {
            const glm::dvec3 r = pixel_of(scale, i);
            // A black reference has no scale: its relative error is the absolute one.
            const glm::dvec3 weight = mean > 0 ? 1.0 / (r * r + 0.01 * mean * mean) : one;
            const glm::dvec3 error = squared_error(i), uncertainty = variance(i);
            sum += glm::dvec4(glm::dot(one, error), glm::dot(weight, error), glm::dot(one, uncertainty),
                              glm::dot(weight, uncertainty));
        }
        return sum;
    });
    ErrorMetrics result;
    result.mse_uncorrected = sums[0] / count;
    result.rel_mse_uncorrected = sums[1] / count;
    result.mse = std::max(result.mse_uncorrected - sums[2] / count, 0.0);
    result.rel_mse = std::max(result.rel_mse_uncorrected - sums[3] / count, 0.0);
    result.rel_rmse = std::sqrt(result.rel_mse);
    return result;
}

// Replaces every pixel by the mean of its block of 8 x 8 pixels.
Image block_means(Image image) {
    constexpr uint32_t size = 8;
    in_parallel(image.height, size, [&](size_t top, size_t bottom) {
        for (size_t left = 0; left < image.width; left += size)
            for (size_t channel = 0; channel < 3; ++channel) {
                const size_t right = std::min<size_t>(left + size, image.width);
                const auto index = [&](size_t x, size_t y) { return 3 * (y * image.width + x) + channel; };
                double sum = 0;
                for (size_t y = top; y < bottom; ++y)
                    for (size_t x = left; x < right; ++x) sum += image.pixels[index(x, y)];
                const auto mean = static_cast<float>(sum / static_cast<double>((bottom - top) * (right - left)));
                for (size_t y = top; y < bottom; ++y)
                    for (size_t x = left; x < right; ++x) image.pixels[index(x, y)] = mean;
            }
    });
    return image;
}

}  // namespace

Reference::Part Reference::part(size_t channel, glm::uvec2 corner, glm::uvec2 size) const {
    Part sum{0, 0};
    for (uint32_t y = corner.y; y < corner.y + size.y; ++y)
        for (uint32_t x = corner.x; x < corner.x + size.x; ++x) {
            const size_t i = 3 * (size_t{y} * mean.width + x) + channel;
            sum.mean += mean.pixels[i];
            if (variance) sum.variance += variance->pixels[i];
        }
    const double count = static_cast<double>(size_t{size.x} * size.y);
    return {sum.mean / count, sum.variance / (count * count)};
}

Reference read_reference(const std::filesystem::path& file) {
    ExrFile exr = read_exr(file);
    if (!exr.is_complete) throw UserError(file.string() + ": lacks pixels of its display window: it cannot serve as a reference");
    Reference reference{std::move(exr.image), std::nullopt, std::move(exr.attributes)};
    if (const auto filter = reference.attributes.find("filter"); filter != reference.attributes.end())
        throw UserError(file.string() + ": is filtered (" + filter->second +
                        "), and its bias would count as the error of other pictures: it cannot serve as a reference");
    if (!std::all_of(reference.mean.pixels.begin(), reference.mean.pixels.end(),
                     [](float value) { return std::isfinite(value); }))
        throw UserError(file.string() + ": has infinite pixels: it cannot serve as a reference");
    Image variance{reference.mean.width, reference.mean.height, std::vector<float>(reference.mean.pixels.size())};
    const std::array<std::string, 3> names{"variance.R", "variance.G", "variance.B"};
    for (size_t channel = 0; channel < 3; ++channel) {
        const auto found = exr.channels.find(names[channel]);
        if (found == exr.channels.end()) return reference;
        for (size_t i = 0; i < found->second.size(); ++i) variance.pixels[3 * i + channel] = found->second[i];
    }
    reference.variance = std::move(variance);
    return reference;
}

ErrorMetrics compare(const Image& image, const Reference& reference) {
    return metrics(
        reference.mean,
        [&](size_t i) {
            const glm::dvec3 error = pixel_of(image, i) - pixel_of(reference.mean, i);
            return error * error;
        },
        [&](size_t i) { return reference.variance ? pixel_of(*reference.variance, i) : glm::dvec3(0); });
}

std::optional<ErrorMetrics> estimate_error(const FilmImage& film) {
    Image mean = film.mean();
    const bool is_black = std::ranges::all_of(mean.pixels, [](float value) { return value == 0; });
    if (film.min_samples() < 2 || is_black) return std::nullopt;
    return metrics(
        block_means(std::move(mean)), [&](size_t i) { return variance_of_mean(film.pixels[i]); },
        [](size_t) { return glm::dvec3(0); });
}

FilterError measure_filter_error(const FilmImage& filtered, const FilmImage& raw, const Reference& reference) {
    const auto noise = [&](size_t i) { return variance_of_mean(filtered.pixels[i]); };
    return {.error = compare(filtered.mean(), reference),
            .variance = metrics(reference.mean, noise, [](size_t) { return glm::dvec3(0); }).rel_mse,
            .unfiltered = compare(raw.mean(), reference).rel_mse};
}

FilterError estimate_filter_error(const FilmImage& filtered, const FilmImage& raw) {
    const Image scale = block_means(filtered.mean());
    const auto exactly = [](size_t) { return glm::dvec3(0); };
    const auto squared_difference = [&](size_t i) {
        const auto own = means_of_halves(filtered.pixels[i]), judges = means_of_halves(raw.pixels[i]);
        const glm::dvec3 first = own[0] - judges[1], second = own[1] - judges[0];
        return 0.5 * (first * first + second * second);
    };
    // The judges' own variance, and by how much one filtered half is noisier than the mean of both.
    const auto excess = [&](size_t i) {
        const glm::dvec3 noise = difference_of_halves(raw.pixels[i]), filtered_noise = difference_of_halves(filtered.pixels[i]);
        return 0.5 * noise * noise + 0.25 * filtered_noise * filtered_noise;
    };
    const auto noise_of = [&](const FilmImage& film) {
        return metrics(
                   scale, [&](size_t i) { return variance_of_mean(film.pixels[i]); }, exactly)
            .rel_mse;
    };
    return {.error = metrics(scale, squared_difference, excess), .variance = noise_of(filtered), .unfiltered = noise_of(raw)};
}

NoiseEstimate estimate_noise(const FilmImage& film, glm::uvec2 corner, glm::uvec2 size) {
    NoiseEstimate estimate;
    double variance = 0;
    const glm::uvec2 end = glm::min(corner + size, glm::uvec2(film.width, film.height));
    const double pixels = std::max((end.x - corner.x) * (end.y - corner.y), 1u);
    for (uint32_t y = corner.y; y < end.y; ++y)
        for (uint32_t x = corner.x; x < end.x; ++x) {
            const FilmPixel& pixel = film.pixels[size_t{y} * film.width + x];
            const double count = pixel.sample_count;
            estimate.samples += count / pixels;
            estimate.invalid_samples += pixel.invalid_count;
            estimate.mean += sum_of(pixel) / std::max(count, 1.0) / pixels;
            variance += glm::dot(variance_of_mean(pixel), glm::dvec3(1)) / (3 * pixels);
        }
    estimate.standard_error = std::sqrt(variance);
    const double mean = (estimate.mean[0] + estimate.mean[1] + estimate.mean[2]) / 3;
    estimate.relative_error = mean > 0 ? estimate.standard_error / mean : 0;
    return estimate;
}

}  // namespace lab
