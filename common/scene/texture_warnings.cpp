#include "scene/texture_warnings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lab {

std::vector<std::string> texture_warnings(const Scene& scene) {
    std::vector<std::string> warnings;
    if (scene.texture_coordinates.empty()) return warnings;
    for (const Mesh& mesh : scene.meshes) {
        float farthest = 0, step = 0, steps_in_texels = 0;
        for (uint32_t t = mesh.first_triangle; t < mesh.first_triangle + mesh.triangle_count; ++t) {
            const int texture = scene.materials[scene.triangle_materials[t]].albedo_texture;
            if (texture < 0) continue;
            const Texture& image = scene.textures[static_cast<size_t>(texture)];
            for (int i = 0; i < 3; ++i) {
                const vec2 uv = glm::abs(scene.texture_coordinates[scene.triangles[t][i]]);
                const float size = std::max(uv.x, uv.y), spacing = std::nextafter(size, INFINITY) - size;
                const float texels = spacing * static_cast<float>(std::max(image.width, image.height));
                if (texels <= steps_in_texels) continue;
                farthest = size;
                step = spacing;
                steps_in_texels = texels;
            }
        }
        if (steps_in_texels <= 1) continue;
        char text[200];
        std::snprintf(
            text, sizeof text,
            "texture coordinates reach %.3g, where floats are %.2g apart: steps of %.3g texels show; "
            "move them closer to 0",
            double{farthest}, double{step}, double{steps_in_texels});
        warnings.push_back(mesh.file + ": " + text);
    }
    return warnings;
}

}  // namespace lab
