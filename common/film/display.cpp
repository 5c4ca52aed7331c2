#include "film/display.h"

#include <algorithm>
#include <cmath>

#include "parallel.h"

namespace lab {

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
