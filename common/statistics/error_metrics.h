// The error of an image against a reference, or estimated from the image itself; the noise of its parts.
#pragma once
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>

#include "film/film_image.h"
#include "image/image.h"

namespace lab {

// The error of a value x is x - r. If the variance of the reference r is known, it is subtracted.
struct ErrorMetrics {
    double mse = 0;                  // mean over pixels and channels of (x - r)^2
    double rel_mse = 0;              // mean of (x - r)^2 / (r^2 + 0.01 r̄^2), r̄ the mean of the reference
    double rel_rmse = 0;             // sqrt(rel_mse): the error that the program prints
    double mse_uncorrected = 0;      // without the subtraction
    double rel_mse_uncorrected = 0;  // without the subtraction
};

struct Reference {
    Image mean;
    std::optional<Image> variance;                       // of the mean, from channels variance.R, variance.G, variance.B
    std::map<std::string, std::string> attributes = {};  // of the file: scene, scene_hash, max_path_length, …

    // Mean of a channel over a rectangle of pixels, and the variance of that mean (0 if unknown).
    struct Part {
        double mean;
        double variance;
    };
    Part part(size_t channel, glm::uvec2 corner, glm::uvec2 size) const;
};

// Throws UserError if the file is damaged.
Reference read_reference(const std::filesystem::path& file);

// Image and reference must have the same size.
ErrorMetrics compare(const Image& image, const Reference& reference);

// Estimates the error of a film from the halves of its samples. Errors are relative to means over 8 x 8 pixels, since a noisy
// pixel's own value would excuse its error. Unknown before every pixel has two samples, and while the film is black: black halves
// agree by chance.
std::optional<ErrorMetrics> estimate_error(const FilmImage& film);

// The error of a filtered film, of which a part is variance, and the rest the square of a bias; and that of the film before it
// was filtered. The last two are relative mean squared errors, too.
struct FilterError {
    ErrorMetrics error;
    double variance = 0;
    double unfiltered = 0;
    double squared_bias() const { return error.rel_mse > variance ? error.rel_mse - variance : 0; }
};
FilterError measure_filter_error(const FilmImage& filtered, const FilmImage& raw, const Reference& reference);
// Without a reference: a filtered half F_A does not know the other half B, which is right on average, so the mean of (F_A - B)²
// is the squared error of F_A plus the variance of B, which is half the mean of (A - B)².
FilterError estimate_filter_error(const FilmImage& filtered, const FilmImage& raw);

// The noise of a rectangle of pixels.
struct NoiseEstimate {
    glm::dvec3 mean{0};
    // Root mean square of the pixels' standard errors over pixels and channels; below, relative to the rectangle's mean.
    double standard_error = 0;
    double relative_error = 0;
    double samples = 0;  // per pixel, on average
    uint64_t invalid_samples = 0;
};

// Estimates noise from the halves of the samples, ignoring pixels with fewer than two.
NoiseEstimate estimate_noise(const FilmImage& film, glm::uvec2 corner, glm::uvec2 size);

}  // namespace lab
