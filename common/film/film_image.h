// The sums of an image's samples, and how they are displayed.
#pragma once
#include <string>
#include <vector>

#include "image/image.h"
#include "shaders/interface.h"

namespace lab {

inline constexpr size_t pixels_per_piece = 1 << 16;  // per task of a thread

// The sum of a pixel's samples, stored as two floats.
inline glm::dvec3 sum_of(const FilmPixel& pixel) { return glm::dvec3(pixel.sum) + glm::dvec3(pixel.compensation); }

// Stores a sum as two floats.
void set_sum(FilmPixel& pixel, const glm::dvec3& sum);

// Rounds. In loops over floats and doubles GCC 12 optimises a cast away.
float to_float(double number);

// The means of the first, third, … sample and of the others: two independent estimates. 0 with fewer than two samples.
std::array<glm::dvec3, 2> means_of_halves(const FilmPixel& pixel);
// The first of them minus the second.
glm::dvec3 difference_of_halves(const FilmPixel& pixel);
// The variance of the mean of all samples, estimated from that difference.
glm::dvec3 variance_of_mean(const FilmPixel& pixel);

// The contents of a film: pixels row by row from the top.
struct FilmImage {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<FilmPixel> pixels;

    uint32_t min_samples() const;                    // smallest count of any pixel
    bool exceeds(uint32_t samples) const;            // whether some pixel has more than this, the smallest count
    uint64_t sum(uint32_t FilmPixel::*count) const;  // of all pixels
    uint64_t invalid_samples() const { return sum(&FilmPixel::invalid_count); }  // infinite or NaN
    Image mean() const;                                                          // per pixel; 0 without samples
    std::array<double, 3> mean_radiance() const;                                 // of the whole image
    std::array<double, 3> mean_difference() const;                               // of the halves, of the whole image
};

// For messages: "640x480".
std::string size_text(const uvec2& size);

// How values become colours: views of normals, depth and the like are not radiance.
enum class DisplayTransform {
    exposure,  // times 2^exposure, clamped, sRGB-encoded
    maximum,   // divided by the largest finite value of the image
    as_is,     // clamped; already a colour
};

// Pixels with invalid samples are magenta, and negative ones, of a derivative, are blue.
Texture to_display(const FilmImage& film, DisplayTransform transform, float exposure);

}  // namespace lab
