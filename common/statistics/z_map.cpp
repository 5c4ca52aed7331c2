#include "statistics/z_map.h"

#include <algorithm>
#include <cmath>

namespace lab {

Texture draw_z_map(const ZMap& map, uint32_t magnification) {
    Texture texture{map.width * magnification, map.height * magnification, {}};
    texture.pixels.reserve(size_t{4} * texture.width * texture.height);
    for (uint32_t y = 0; y < texture.height; ++y)
        for (uint32_t x = 0; x < texture.width; ++x) {
            const double z = map.values[size_t{y} / magnification * map.width + x / magnification] / 5;
            for (const double value : {1 + std::min(z, 0.0), 1 - std::abs(z), 1 - std::max(z, 0.0), 1.0})
                texture.pixels.push_back(
                    static_cast<uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0))));
        }
    return texture;
}

}  // namespace lab
