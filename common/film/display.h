// From radiance to what a screen shows.
#pragma once
#include "film/film_image.h"

namespace lab {

// How numbers become colours. Views of normals, depth and the like are not radiance.
enum class DisplayTransform {
    exposure,  // times 2^exposure, clamped, sRGB-encoded
    maximum,   // divided by the largest finite value of the image
    as_is,     // clamped; already a colour
};

// Pixels with invalid samples are magenta.
Texture to_display(const FilmImage& film, DisplayTransform transform, float exposure);

}  // namespace lab
