#include "scene/precision_warnings.h"

#include <cmath>
#include <cstdio>

namespace lab {
namespace {

constexpr double rounding = 0x1p-24;  // of 32-bit numbers, relative

std::string to_text(double number) {
    char text[16];
    std::snprintf(text, sizeof text, "%.2g", number);
    return text;
}

}  // namespace

std::vector<std::string> precision_warnings(const Scene& scene) {
    std::vector<std::string> warnings;
    const std::string name = scene.file.string();
    if (!scene.instances.empty()) {
        const Bounds bounds = world_bounds(scene);
        const glm::dvec3 low(bounds.low), high(bounds.high),
            farthest = glm::max(glm::abs(low), glm::abs(high));
        // As get_surface_point() of shaders/shading_data.glsl moves rays off a surface that is not slender.
        const double offset = 8 * rounding * (farthest.x + farthest.y + farthest.z);
        const double part = offset / glm::distance(low, high);
        if (part > 1e-3)
            warnings.push_back(name + ": it is so far from the origin that 32-bit coordinates blur " +
                               to_text(100 * part) + " % of its size; move it closer");
    }
    const double row =
        2 * std::tan(glm::radians(0.5 * double{scene.camera.vertical_fov})) / scene.defaults.height;
    if (row < 10 * rounding)
        warnings.push_back(name + ": the field of view is so narrow that 32-bit directions are rounded to " +
                           to_text(rounding / row) + " of a pixel; move the camera closer");
    return warnings;
}

}  // namespace lab
