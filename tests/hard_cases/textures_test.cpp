// Textures of extreme sizes, and texture coordinates far outside [0,1].
#include "support/textures.h"

#include <cmath>

#include "support/device_arithmetic.h"
#include "support/gpu_test.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;

class TextureCases : public OnEachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, TextureCases, testing::ValuesIn(all_backends), own_backend_name);

// A distinct colour for each texel: the column in red and green, the row in blue and green.
Texture numbered_texture(uint32_t width, uint32_t height) {
    Texture texture{width, height, {}};
    texture.pixels.reserve(size_t{4} * width * height);
    for (uint32_t row = 0; row < height; ++row)
        for (uint32_t column = 0; column < width; ++column)
            for (const uint32_t value : {column, (column >> 8) * 7 + (row >> 8), row, 255u})
                texture.pixels.push_back(static_cast<uint8_t>(value));
    return texture;
}

// The largest error of the colours at texel centres, some repetitions away. A position that is off by a fraction of a texel mixes
// in the same fraction of a neighbour.
double largest_error(Backend backend, const Texture& texture, const std::vector<uvec2>& texels, const vec2& repetitions) {
    std::vector<vec2> coordinates;
    for (const uvec2& position : texels)
        coordinates.emplace_back((glm::dvec2(position) + 0.5) / glm::dvec2(texture.width, texture.height) +
                                 glm::dvec2(repetitions));
    const auto albedos = albedo_at(backend, texture, coordinates);
    double largest = 0;
    for (size_t i = 0; i < albedos.size(); ++i)
        largest = std::max(largest, glm::distance(dvec3(albedos[i]), texel(texture, texels[i].x, texels[i].y)));
    return largest;
}

// Twice the device's decoding error, plus rounding.
double decoding_error() { return 2 * test_arithmetic().decoding + 1e-6; }

TEST_P(TextureCases, OneTexelIsAColour) {
    const Texture texture{1, 1, {200, 100, 50, 255}};
    std::vector<vec2> coordinates;
    for (const float u : {0.0f, 0.3f, 1.0f, -1e-9f, -0.5f, 1e4f, -1e6f, 8388607.5f})
        for (const float v : {0.0f, 0.99999994f, -1e-9f, -1e6f, 1e6f}) coordinates.emplace_back(u, v);
    for (const vec3& albedo : albedo_at(GetParam(), texture, coordinates))
        ASSERT_LT(glm::distance(dvec3(albedo), texel(texture, 0, 0)), decoding_error());
}

TEST_P(TextureCases, SizesNeedNotBePowersOfTwo) {
    double worst = 0;
    for (const uvec2 size : {uvec2(13, 7), uvec2(1, 5), uvec2(641, 3), uvec2(3, 255)}) {
        std::vector<uvec2> texels;
        for (uint32_t i = 0; i < 200; ++i) texels.emplace_back(i * 29 % size.x, i * 53 % size.y);
        const Texture texture = numbered_texture(size.x, size.y);
        for (const vec2 repetitions : {vec2(0), vec2(-1, 1)})
            worst = std::max(worst, largest_error(GetParam(), texture, texels, repetitions));
    }
    record("largest_error_of_a_colour", "%.1e", worst);
    // A centre such as 3.5/641 is not a float: with its repetition added it is off by 2^-24, 4e-5 texels.
    EXPECT_LT(worst, decoding_error() + 1e-4);
}

// The threads of a group see textures of all sizes at once.
TEST_P(TextureCases, NeighboursHaveDifferentSizes) {
    const std::vector<Texture> textures{numbered_texture(13, 7), numbered_texture(1, 5), numbered_texture(200, 3)};
    std::vector<vec2> coordinates;
    std::vector<dvec3> expected;
    for (uint32_t i = 0; i < 400; ++i) {
        const Texture& texture = textures[i % textures.size()];
        const uvec2 position(i * 29 % texture.width, i * 53 % texture.height);
        coordinates.emplace_back((glm::dvec2(position) + 0.5) / glm::dvec2(texture.width, texture.height));
        expected.push_back(texel(texture, position.x, position.y));
    }
    const auto albedos = albedo_at(GetParam(), textures, coordinates);
    for (size_t i = 0; i < albedos.size(); ++i)
        ASSERT_LT(glm::distance(dvec3(albedos[i]), expected[i]), decoding_error() + 1e-4) << "texture " << i % 3;
}

TEST_P(TextureCases, LargeOnesShowEveryTexel) {
    constexpr uint32_t size = 8192;
    const Texture texture = numbered_texture(size, size);
    std::vector<uvec2> texels{{0, 0}, {size - 1, 0}, {0, size - 1}, {size - 1, size - 1}};
    for (uint32_t i = 0; i < 400; ++i) texels.emplace_back(i * 2657 % size, i * 5843 % size);
    const double worst = largest_error(GetParam(), texture, texels, vec2(0));
    record("largest_error_of_a_colour", "%.1e of 8192 x 8192 texels", worst);
    EXPECT_LT(worst, decoding_error());
}

TEST_P(TextureCases, CoordinatesMayLieFarOutside) {
    // Centres of 4 x 2 texels are multiples of 1/8, which floats represent up to 2^20.
    const Texture texture = numbered_texture(4, 2);
    std::vector<uvec2> texels;
    for (uint32_t column = 0; column < 4; ++column)
        for (uint32_t row = 0; row < 2; ++row) texels.emplace_back(column, row);
    double worst = 0;
    for (const float far : {1e4f, -1e4f, 1e6f, -1e6f})
        for (const vec2 repetitions : {vec2(far, 0), vec2(0, far), vec2(far, -far)})
            worst = std::max(worst, largest_error(GetParam(), texture, texels, repetitions));
    record("largest_error_of_a_colour", "%.1e up to 1e6 repetitions away", worst);
    EXPECT_LT(worst, decoding_error());
}

TEST_P(TextureCases, FarCoordinatesAreInterpolatedAsNearOnes) {
    // The triangle's own coordinates are exact; those in between must not lose the digits that floats near 10^6 lack.
    const auto coordinates_at = [&](float far) {
        Scene scene = make_scene({diffuse_material(vec3(1))}, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
        scene.textures = {numbered_texture(4, 2)};
        const vec2 corner(far + 0.125f, -far - 0.25f);
        scene.texture_coordinates = {corner, corner + vec2(0.5f, 0), corner + vec2(0.5f, 0.125f), corner + vec2(0, 0.125f)};
        scene.camera = {{0.5f, 0.5f, 2}, {0.5f, 0.5f, 0}, {0, 1, 0}, 20};
        return render(
            scene,
            {.width = 16, .height = 16, .samples = 1, .estimator = view_estimator("texture-coordinates"), .backend = GetParam()});
    };
    const FilmImage near = coordinates_at(0);
    double worst = 0;
    for (const float far : {1e4f, 1e6f}) {
        const FilmImage film = coordinates_at(far);
        for (size_t i = 0; i < film.pixels.size(); ++i)
            worst = std::max(worst, double{glm::distance(film.pixels[i].sum, near.pixels[i].sum)});
    }
    record("largest_difference_of_a_coordinate", "%.2g up to 1e6 repetitions away", worst);
    EXPECT_LT(worst, 1e-6);
}

TEST_P(TextureCases, RepeatWithinATriangle) {
    // A square with two and a half repetitions in one direction, and the same in pieces of at most one repetition.
    const auto render_pieces = [&](int direction,
                                   const std::vector<vec2>& pieces) {  // first and last coordinate
        std::vector<Quad> quads;
        std::vector<vec2> coordinates;
        float x = 0;
        for (const vec2& ends : pieces) {
            const float width = (ends.y - ends.x) / 2.5f;
            quads.push_back({{x, 0, 0}, {width, 0, 0}, {0, 1, 0}});
            for (const vec2 uv : {vec2(ends.x, -1.5f), vec2(ends.y, -1.5f), vec2(ends.y, -1), vec2(ends.x, -1)})
                coordinates.emplace_back(uv[direction], uv[1 - direction]);
            x += width;
        }
        Material material = diffuse_material(vec3(1));
        material.albedo_texture = 0;
        Scene scene = make_scene({material}, quads);
        scene.textures = {numbered_texture(8, 4)};
        scene.texture_coordinates = coordinates;
        scene.camera = {{0.5f, 0.5f, 2}, {0.5f, 0.5f, 0}, {0, 1, 0}, 20};
        return render(scene,
                      {.width = 32, .height = 32, .samples = 1, .estimator = view_estimator("albedo"), .backend = GetParam()});
    };
    for (const int direction : {0, 1}) {
        const FilmImage whole = render_pieces(direction, {{0.25f, 2.75f}}),
                        pieces = render_pieces(direction, {{0.25f, 1}, {0, 1}, {0, 0.75f}});
        for (size_t i = 0; i < whole.pixels.size(); ++i)
            ASSERT_LT(glm::distance(whole.pixels[i].sum, pieces.pixels[i].sum), 1e-5f) << "pixel " << i;
    }
}

}  // namespace
}  // namespace lab
