// The lens: what is out of focus becomes a disc of the right size and brightness.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "support/expect_statistics.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

constexpr double focus = 4;  // distance of the plane in focus

// The camera at the origin looks along -Z. Its picture shows a square of this side in the plane in focus. Camera and scene are
// turned together, so that a lens along axes of the scene shows.
Scene seen(const Scene& scene, double aperture_diameter, double field = 2) {
    const dmat3 turn(glm::rotate(glm::dmat4(1), 0.7, glm::normalize(dvec3(1, 2, 0.5))));
    Scene result = scene;
    for (vec3& position : result.positions) position = turn * dvec3(position);
    result.camera = {.position = {0, 0, 0},
                     .target = turn * dvec3(0, 0, -1),
                     .up = turn * dvec3(0, 1, 0),
                     .vertical_fov = static_cast<float>(glm::degrees(2 * std::atan(0.5 * field / focus))),
                     .aperture_diameter = static_cast<float>(aperture_diameter),
                     .focus_distance = static_cast<float>(focus)};
    return result;
}

// A square lamp of radiance 1 on the axis, which faces the camera.
Scene lamp(double distance, double side) {
    const auto s = static_cast<float>(side), z = static_cast<float>(-distance);
    return make_scene({diffuse_material(vec3(0), vec3(1))}, {{{-0.5f * s, -0.5f * s, z}, {s, 0, 0}, {0, s, 0}}});
}

RenderSettings lens_settings(uint32_t samples) {
    return {.width = 48,
            .height = 48,
            .samples = samples,
            .max_path_length = 0,
            .estimator = chapter_estimator(chapter_named("lens")),
            .backend = fastest_backend()};
}

struct BlurredLamp {
    const char* name;
    double distance, side, aperture;
};
class LensDisc : public testing::TestWithParam<BlurredLamp> {};
INSTANTIATE_TEST_SUITE_P(, LensDisc,
                         testing::Values(BlurredLamp{"behind", 8, 0.2, 0.8}, BlurredLamp{"before", 2.5, 0.056, 0.6},
                                         BlurredLamp{"far_behind_all", 400, 22, 0.9},
                                         BlurredLamp{"larger_than_its_blur_all", 6, 0.5, 0.7}),
                         [](const auto& of) { return of.param.name; });

// In the plane in focus, the picture of a lamp is its pinhole's picture, smeared over the aperture as seen from the lamp: a disc
// of diameter c = A |z - f| / z. So its sum is the pinhole's, and the mean square of the distance from the axis is the sum of
// those of the two shapes, c²/8 for the disc and s²/6 for a square of side s.
TEST_P(LensDisc, ShowsADiscOfTheRightSizeAndBrightness) {
    const auto& [name, distance, side, aperture] = GetParam();
    const double c = aperture * std::abs(distance - focus) / distance, s = side * focus / distance;
    const double field = 1.2 * (c + s), pixel = field / lens_settings(1).width;
    constexpr uint32_t batch_count = 40;
    const Batches batches = render_batches(seen(lamp(distance, side), aperture, field), lens_settings(1024), batch_count);
    std::vector<double> areas, squares, centres;
    for (const auto& image : batches.images) {
        double sum = 0, square = 0, centre = 0, centre_pixels = 0;
        for (uint32_t y = 0; y < batches.height; ++y)
            for (uint32_t x = 0; x < batches.width; ++x) {
                const dvec2 position = field * ((dvec2(x, y) + 0.5) / static_cast<double>(batches.width) - 0.5);
                const double radiance = image[size_t{y} * batches.width + x][0];
                sum += radiance * pixel * pixel;
                // Moments of a histogram are too large by a twelfth of its squared width, here in two dimensions (Sheppard).
                square += radiance * pixel * pixel * (glm::dot(position, position) - pixel * pixel / 6);
                if (glm::length(position) < 0.5 * c - s) centre += radiance, ++centre_pixels;
            }
        areas.push_back(sum);
        squares.push_back(square / sum);
        if (centre_pixels > 0) centres.push_back(centre / centre_pixels);
    }
    expect_mean("sum", estimate_mean(areas), s * s, 0.003, 3);
    expect_mean("mean square of the distance from the axis", estimate_mean(squares), c * c / 8 + s * s / 6, 0.003, 3);
    if (!centres.empty())
        expect_mean("radiance in the middle", estimate_mean(centres), s * s / (std::numbers::pi / 4 * c * c), 0.003, 3);
}

// A lamp in the plane in focus is as sharp as through a pinhole, wherever it is: that plane is no sphere.
TEST(Lens, APlaneIsInFocus) {
    Scene scene = lamp(focus, 0.5);
    for (vec3& position : scene.positions) position += vec3(0.5, 0.5, 0);
    const FilmImage film = render(seen(scene, 8), lens_settings(64));  // a sphere would blur the lamp over seven pixels
    for (uint32_t y = 0; y < film.height; ++y)
        for (uint32_t x = 0; x < film.width; ++x) {
            const bool is_lamp = x >= 30 && x < 42 && y >= 6 && y < 18;
            const bool is_edge = x == 29 || x == 30 || x == 41 || x == 42 || y == 5 || y == 6 || y == 17 || y == 18;
            if (is_edge) continue;
            ASSERT_EQ(film.pixels[size_t{y} * film.width + x].sum.r, is_lamp ? 64 : 0) << x << ", " << y;
        }
}

// A length is a length: scenes scaled by a power of two have the same pixels, to the bit.
TEST(Lens, ScenesOfAnySizeLookTheSame) {
    const auto scaled = [](float scale) {
        Scene scene = seen(lamp(6, 0.5), 0.7);
        for (vec3& position : scene.positions) position *= scale;
        scene.camera.target *= scale;
        scene.camera.aperture_diameter *= scale;
        scene.camera.focus_distance *= scale;
        return render(scene, lens_settings(16));
    };
    const FilmImage expected = scaled(1);
    EXPECT_GT(expected.mean_radiance()[0], 0);
    for (const float scale : {0x1p-20f, 0x1p20f}) {
        const FilmImage film = scaled(scale);
        for (size_t i = 0; i < expected.pixels.size(); ++i)
            ASSERT_EQ(film.pixels[i].sum, expected.pixels[i].sum) << scale << ", pixel " << i;
    }
}

// Focus behind everything or close to the lens, an aperture larger than the scene: a white floor under a white sky is white. From
// within a ball of glass, radiance is larger by the square of the index.
TEST(Lens, ExtremesLoseNoLight) {
    Material glass = diffuse_material(vec3(0));
    glass.refractive_index = 1.5f;
    for (const bool is_in_glass : {false, true})
        for (const double aperture : {1e-6, 0.4, 1e3})
            for (const double distance : {1e-3, 2.0, 1e9, 1e20, 1e30}) {
                if (is_in_glass && aperture > 1) continue;
                Scene scene = is_in_glass ? make_sphere(glass, Facing::outwards)
                                          : make_scene({diffuse_material(vec3(1))}, {{{-1, -1, -3}, {2, 0, 0}, {0, 2, 0}}});
                scene = seen(scene, aperture);
                scene.camera.focus_distance = static_cast<float>(distance);
                scene.background = vec3(1);
                RenderSettings settings = lens_settings(4);
                settings.max_path_length = 100;
                settings.roulette_start = no_roulette;
                const double expected = is_in_glass ? 1.5 * 1.5 : 1;
                for (const FilmPixel& pixel : render(scene, settings).pixels) ASSERT_NEAR(pixel.sum.r, 4 * expected, 1e-4);
            }
}

}  // namespace
}  // namespace lab
