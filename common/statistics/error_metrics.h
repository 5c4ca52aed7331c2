// How far an image is from a reference, or from its own expectation.
#pragma once
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>

#include "film/film_image.h"
#include "image/image.h"

namespace lab {

// With a reference x - r is the error; the variance of the reference, where known, is subtracted.
struct ErrorMetrics {
    double mse = 0;                  // mean over pixels and channels of (x - r)^2
    double rel_mse = 0;              // mean of (x - r)^2 / (r^2 + 0.01 r̄^2), r̄ the mean of the reference
    double rel_rmse = 0;             // sqrt(rel_mse): the error that the program prints
    double mse_uncorrected = 0;      // without the subtraction
    double rel_mse_uncorrected = 0;  // without the subtraction
};

struct Reference {
    Image mean;
    std::optional<Image> variance;  // of the mean, from the channels variance.R, variance.G, variance.B
    std::map<std::string, std::string> attributes = {};  // of the file: scene, scene_hash, max_path_length, …

    // Mean of a channel over the rectangle with this corner and size in pixels, and the variance of that mean
    // (0 if unknown).
    struct Part {
        double mean;
        double variance;
    };
    Part part(size_t channel, glm::uvec2 corner, glm::uvec2 size) const;
};

// Throws UserError if the file is damaged.
Reference read_reference(const std::filesystem::path& file);

// Both images have the same size.
ErrorMetrics compare(const Image& image, const Reference& reference);

// Expected error of the mean (first + second) / 2 of two independent renders with equally many samples,
// estimated from their difference: its expected square is four times the variance of the mean. The unknown
// reference is replaced by the mean over blocks of 8 x 8 pixels: a noisy pixel's own value would excuse its
// error.
ErrorMetrics estimate_error(const Image& first, const Image& second);

// Of a rectangle of pixels.
struct NoiseEstimate {
    glm::dvec3 mean{0};
    // Root mean square of the standard deviation of the pixels' means, over pixels and channels, and the same
    // as part of the mean of the rectangle.
    double standard_error = 0;
    double relative_error = 0;
    double samples = 0;  // a pixel, on average
    uint64_t invalid_samples = 0;
};

// From an earlier and a later state of the same film: their samples differ by independent ones, whose mean
// differs from the earlier mean by noise only. The standard error is 0 where there are no samples in either
// part.
NoiseEstimate estimate_noise(const FilmImage& earlier, const FilmImage& later, glm::uvec2 corner,
                             glm::uvec2 size);

}  // namespace lab
