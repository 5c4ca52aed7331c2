// What the samples of an image have added up to.
#pragma once
#include <string>
#include <vector>

#include "image/image.h"
#include "shaders/interface.h"

namespace lab {

// The sum of a pixel's samples, which two floats hold together.
inline glm::dvec3 sum_of(const FilmPixel& pixel) {
    return glm::dvec3(pixel.sum) + glm::dvec3(pixel.compensation);
}

// The contents of a film: pixels row by row from the top.
struct FilmImage {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<FilmPixel> pixels;

    bool has_equal_sample_counts() const;
    uint32_t min_samples() const;                 // samples that every pixel has
    uint64_t invalid_samples() const;             // samples that were infinite or not a number
    Image mean() const;                           // mean radiance of a pixel; 0 where there are no samples
    std::array<double, 3> mean_radiance() const;  // of the whole image
};

// For messages: "640x480".
std::string size_text(const uvec2& size);

// The samples of `whole` that came after those of `first`, an earlier state of the same film.
FilmImage samples_after(const FilmImage& first, const FilmImage& whole);

// How numbers become colours. Views of normals, depth and the like are not radiance.
enum class DisplayTransform {
    exposure,  // times 2^exposure, clamped, sRGB-encoded
    maximum,   // divided by the largest finite value of the image
    as_is,     // clamped; already a colour
};

// Pixels with invalid samples are magenta.
Texture to_display(const FilmImage& film, DisplayTransform transform, float exposure);

}  // namespace lab
