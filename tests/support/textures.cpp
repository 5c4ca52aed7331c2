#include "support/textures.h"

#include <cmath>

#include "support/scenes.h"

namespace lab {

std::vector<vec3> albedo_at(Backend backend, const Texture& texture, const std::vector<vec2>& coordinates, const vec3& factor) {
    return albedo_at(backend, std::vector{texture}, coordinates, factor);
}

std::vector<vec3> albedo_at(Backend backend, const std::vector<Texture>& textures, const std::vector<vec2>& coordinates,
                            const vec3& factor) {
    std::vector<Material> materials(textures.size(), diffuse_material(factor));
    for (size_t i = 0; i < textures.size(); ++i) materials[i].albedo_texture = static_cast<int>(i);
    // Each quad fills three pixels, and the middle one is read: a ray through the edge of a pixel may hit the adjacent quad.
    constexpr uint32_t width = 3;
    std::vector<Quad> quads;
    for (size_t i = 0; i < coordinates.size(); ++i)
        quads.push_back({{width * i, -1, 0}, {width, 0, 0}, {0, 3, 0}, static_cast<uint32_t>(i % textures.size())});
    Scene scene = make_scene(materials, quads);
    scene.textures = textures;
    for (const vec2& uv : coordinates) scene.texture_coordinates.insert(scene.texture_coordinates.end(), 4, uv);
    const auto count = static_cast<uint32_t>(coordinates.size());
    const float distance = 10, middle = 0.5f * static_cast<float>(width * count);
    scene.camera = {{middle, 0.5f, distance}, {middle, 0.5f, 0}, {0, 1, 0}, 0};
    scene.camera.vertical_fov = static_cast<float>(glm::degrees(2 * std::atan(0.5 / double{distance})));
    const FilmImage film = render(
        scene, {.width = width * count, .height = 1, .samples = 1, .estimator = view_estimator("albedo"), .backend = backend});
    std::vector<vec3> albedos;
    for (uint32_t x = 0; x < count; ++x) albedos.push_back(radiance_at(film, width * x + 1, 0));
    return albedos;
}

double decode_srgb(uint8_t value) {
    const double encoded = value / 255.0;
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

glm::dvec3 texel(const Texture& texture, uint32_t column, uint32_t row) {
    const uint8_t* bytes = &texture.pixels[4 * (size_t{row} * texture.width + column)];
    return {decode_srgb(bytes[0]), decode_srgb(bytes[1]), decode_srgb(bytes[2])};
}

}  // namespace lab
