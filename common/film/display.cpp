#include "film/display.h"

#include <algorithm>
#include <cmath>

namespace lab {

Texture to_display(const FilmImage& film, DisplayTransform transform, float exposure) {
    const Image mean = film.mean();
    float scale = 1;
    if (transform == DisplayTransform::exposure) scale = std::exp2(exposure);
    if (transform == DisplayTransform::maximum && !mean.pixels.empty()) {
        const float largest = *std::max_element(mean.pixels.begin(), mean.pixels.end());
        if (largest > 0) scale = 1 / largest;
    }
    Texture result{film.width, film.height, {}};
    result.pixels.reserve(4 * film.pixels.size());
    for (size_t i = 0; i < film.pixels.size(); ++i) {
        if (film.pixels[i].invalid_count > 0) {
            result.pixels.insert(result.pixels.end(), {255, 0, 255, 255});
            continue;
        }
        for (size_t channel = 0; channel < 3; ++channel) {
            float value = std::clamp(scale * mean.pixels[3 * i + channel], 0.0f, 1.0f);
            if (transform == DisplayTransform::exposure) value = linear_to_srgb(value);
            result.pixels.push_back(static_cast<uint8_t>(std::lround(255 * value)));
        }
        result.pixels.push_back(255);
    }
    return result;
}

}  // namespace lab
