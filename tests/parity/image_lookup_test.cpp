// Textures and light probes: which texel a position or direction maps to, on each backend.
#include <array>
#include <cmath>
#include <numbers>

#include "support/device_arithmetic.h"
#include "support/scenes.h"
#include "support/textures.h"

namespace lab {
namespace {

using glm::dvec2;
using glm::dvec3;
using std::numbers::pi;

class Textures : public OnEachBackend {
  protected:
    static std::vector<vec3> albedo_at(const Texture& texture, const std::vector<vec2>& coordinates,
                                       const vec3& factor = vec3(1)) {
        return lab::albedo_at(GetParam(), texture, coordinates, factor);
    }
};
INSTANTIATE_TEST_SUITE_P(Backends, Textures, testing::ValuesIn(all_backends), backend_name);

// Four columns and two rows, all of different colours.
Texture colourful_texture() {
    Texture texture{4, 2, {}};
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 4; ++column)
            for (const int value : {20 + 60 * column, 10 + 200 * row, 255 - 17 * column * (row + 1), 255})
                texture.pixels.push_back(static_cast<uint8_t>(value));
    return texture;
}

// Allowed decoding error: twice that of x^2.4 on the device, plus rounding.
double decoding_error() { return 2 * test_arithmetic().decoding + 1e-6; }

TEST_P(Textures, AreFilteredLinearlyAcrossTheirBorders) {
    const Texture texture = colourful_texture();
    // Between two columns, a quarter of the way between two rows, and between the last and the first of each.
    const auto albedos = albedo_at(texture, {{0.25f, 0.25f}, {0.125f, 0.375f}, {0, 0.25f}, {0.9375f, 0.25f}, {0.125f, 0}});
    const std::array<dvec3, 5> expected{
        0.5 * (texel(texture, 0, 0) + texel(texture, 1, 0)), 0.75 * texel(texture, 0, 0) + 0.25 * texel(texture, 0, 1),
        0.5 * (texel(texture, 3, 0) + texel(texture, 0, 0)), 0.75 * texel(texture, 3, 0) + 0.25 * texel(texture, 0, 0),
        0.5 * (texel(texture, 0, 1) + texel(texture, 0, 0))};
    for (size_t i = 0; i < albedos.size(); ++i) EXPECT_LT(glm::distance(dvec3(albedos[i]), expected[i]), decoding_error()) << i;
}

TEST_P(Textures, AreMultipliedByTheMaterialsColour) {
    const Texture texture = colourful_texture();
    const vec3 factor(0.5f, 0.25f, 0.75f);
    const vec2 centre(0.125f, 0.25f);
    const vec3 plain = albedo_at(texture, {centre}).front();
    EXPECT_LT(glm::distance(albedo_at(texture, {centre}, factor).front(), factor * plain), 1e-6f);
}

TEST_P(Textures, CoordinatesAreInterpolated) {
    Scene scene = make_scene({diffuse_material(vec3(1))}, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    scene.textures = {colourful_texture()};
    scene.texture_coordinates = {{0.1f, 0.9f}, {0.7f, 0.9f}, {0.7f, 0.2f}, {0.1f, 0.2f}};
    scene.camera = {{0.25f, 0.75f, 1}, {0.25f, 0.75f, 0}, {0, 1, 0}, 0.01f};
    const FilmImage film = render(
        scene,
        {.width = 1, .height = 1, .samples = 1, .estimator = view_estimator("texture-coordinates"), .backend = GetParam()});
    EXPECT_LT(glm::distance(radiance_at(film, 0, 0), vec3(0.25f, 0.375f, 0)), 1e-3f);
}

class LightProbe : public OnEachBackend {
  protected:
    // A probe whose texels all have different colours, over an empty scene.
    static constexpr uint32_t width = 9, height = 5;
    static vec3 texel_radiance(uint32_t column, uint32_t row) {
        return {static_cast<float>(column * column), static_cast<float>(row) * 100, static_cast<float>(column + row) + 0.5f};
    }
    static Scene probe_scene() {
        Scene scene = make_scene({}, {});
        scene.background = vec3(1);
        scene.light_probe = Image{width, height, {}};
        for (uint32_t row = 0; row < height; ++row)
            for (uint32_t column = 0; column < width; ++column)
                for (int channel = 0; channel < 3; ++channel)
                    scene.light_probe->pixels.push_back(texel_radiance(column, row)[channel]);
        return scene;
    }
    // Radiance seen by a camera that looks in a direction.
    vec3 radiance(Scene scene, const dvec3& direction) const {
        scene.camera = {.position = {0, 0, 0}, .target = vec3(direction), .up = {0.3f, 0.2f, 0.1f}, .vertical_fov = 0.01f};
        return radiance_at(render(scene, {.width = 1, .height = 1, .samples = 1, .backend = GetParam()}), 0, 0);
    }
};
INSTANTIATE_TEST_SUITE_P(Backends, LightProbe, testing::ValuesIn(all_backends), backend_name);

// +Y up, centre towards -Z; seen from inside, the right half of the image is towards +X.
TEST_P(LightProbe, ShowsItsCentreTowardsMinusZ) {
    const Scene scene = probe_scene();
    const auto expect = [&](const dvec3& direction, const dvec2& position) {
        const auto column = static_cast<uint32_t>(position.x), row = static_cast<uint32_t>(position.y);
        EXPECT_LT(glm::distance(radiance(scene, direction), texel_radiance(column, row)), 0.1f)
            << direction.x << " " << direction.y << " " << direction.z;
    };
    expect({0, 0, -1}, {4, 2});
    for (const dvec2 centre : {dvec2(6, 2), dvec2(2, 2), dvec2(4, 1), dvec2(5, 3), dvec2(0, 1), dvec2(8, 4)}) {
        const double azimuth = 2 * pi * (centre.x + 0.5 - 4.5) / width, inclination = pi * (centre.y + 0.5) / height;
        expect({std::sin(inclination) * std::sin(azimuth), std::cos(inclination), -std::sin(inclination) * std::cos(azimuth)},
               centre);
    }
}

TEST_P(LightProbe, TurnsCounterClockwiseSeenFromAbove) {
    Scene scene = probe_scene();
    scene.probe_rotation = static_cast<float>(pi / 2);
    EXPECT_LT(glm::distance(radiance(scene, {-1, 0, 0}), texel_radiance(4, 2)), 0.1f);
    scene.probe_rotation = static_cast<float>(-pi / 2);
    EXPECT_LT(glm::distance(radiance(scene, {1, 0, 0}), texel_radiance(4, 2)), 0.1f);
}

TEST_P(LightProbe, JoinsAtItsSidesAndEndsAtItsPoles) {
    const Scene scene = probe_scene();
    const vec3 sides = 0.5f * (texel_radiance(0, 2) + texel_radiance(8, 2));
    EXPECT_LT(glm::distance(radiance(scene, {0, 0, 1}), sides), 0.1f);
    // Above the top row of texel centres only that row is visible.
    EXPECT_NEAR(radiance(scene, {0, 1, -0.01}).g, 0, 1e-3);
    EXPECT_NEAR(radiance(scene, {0, -1, -0.01}).g, 100 * (height - 1), 1e-2);
}

TEST_P(LightProbe, IsMultipliedByItsIntensity) {
    Scene scene = probe_scene();
    scene.background = {2, 3, 4};
    EXPECT_LT(glm::distance(radiance(scene, {0, 0, -1}), vec3(2, 3, 4) * texel_radiance(4, 2)), 1.0f);
}

}  // namespace
}  // namespace lab
