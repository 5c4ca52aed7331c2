#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scene/warnings.h"

namespace lab {
namespace {

constexpr double rounding = 0x1p-24;  // of 32-bit numbers, relative

std::string to_text(double number, int digits = 2) {
    char text[16];
    std::snprintf(text, sizeof text, "%.*g", digits, number);
    return text;
}

void check_texture_coordinates(const Scene& scene, std::vector<std::string>& warnings) {
    if (scene.texture_coordinates.empty()) return;
    for (const Mesh& mesh : scene.meshes) {
        float farthest = 0, step = 0, steps_in_texels = 0;
        for (const uint32_t triangle : mesh.triangles()) {
            const int texture = scene.material_of(triangle).albedo_texture;
            if (texture < 0) continue;
            const Texture& image = scene.textures[static_cast<size_t>(texture)];
            for (int i = 0; i < 3; ++i) {
                const vec2 uv = glm::abs(scene.texture_coordinates[scene.triangles[triangle][i]]);
                const float size = std::max(uv.x, uv.y), spacing = std::nextafter(size, INFINITY) - size;
                const float texels = spacing * static_cast<float>(std::max(image.width, image.height));
                if (texels <= steps_in_texels) continue;
                farthest = size;
                step = spacing;
                steps_in_texels = texels;
            }
        }
        if (steps_in_texels > 1)
            warnings.push_back(mesh.file + ": texture coordinates reach " + to_text(farthest, 3) +
                               ", where floats are " + to_text(step) + " apart: steps of " +
                               to_text(steps_in_texels, 3) + " texels show; move them closer to 0");
    }
}

}  // namespace

std::vector<std::string> precision_warnings(const Scene& scene) {
    std::vector<std::string> warnings;
    check_texture_coordinates(scene, warnings);
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
