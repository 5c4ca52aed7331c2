// How noisy parts of an image are.
#pragma once
#include "film/film_image.h"

namespace lab {

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
