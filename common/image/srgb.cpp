#include <algorithm>
#include <cmath>

#include "image/image.h"

namespace lab {

// The curve is linear near black, where a power would have infinite slope. In double, so that the 256 encoded
// values of a byte survive the way to linear float and back exactly.
float linear_to_srgb(float linear) {
    const double value = std::clamp(static_cast<double>(linear), 0.0, 1.0);
    return static_cast<float>(value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055);
}

float srgb_to_linear(float encoded) {
    const double value = std::clamp(static_cast<double>(encoded), 0.0, 1.0);
    return static_cast<float>(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
}

}  // namespace lab
