// Extreme fields of view, image sizes and viewing angles.
#include <cmath>
#include <cstdio>

#include "hard_cases/probe.h"
#include "rendering/renderer.h"
#include "support/gpu_test.h"
#include "support/pcg2d.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;

class HardCamera : public OnEachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, HardCamera, testing::ValuesIn(all_backends), own_backend_name);

// The direction of a camera ray in double, computed from the pose.
dvec3 direction_of(const CameraPose& pose, double width, double height, double x, double y) {
    const dvec3 forward = glm::normalize(dvec3(pose.target) - dvec3(pose.position));
    const dvec3 right = glm::normalize(glm::cross(forward, dvec3(pose.up))), up = glm::cross(right, forward);
    const double tangent = std::tan(glm::radians(0.5 * double{pose.vertical_fov}));
    return glm::normalize(forward + tangent * ((2 * x / width - 1) * width / height * right - (2 * y / height - 1) * up));
}

// A 32-bit direction is accurate to a few times 2^-24, and a position in an image of 2^14 pixels to 2^-10 of a pixel.
TEST_P(HardCamera, RaysHaveTheRightDirections) {
    Scene scene = closed_box(diffuse_material(vec3(0.5f)));
    constexpr double rounding = 4 * 0x1p-24;
    double largest_error = 0, largest_part = 0;
    for (const auto& [width, height] : {std::pair(1u, 1u), {64u, 64u}, {16384u, 1u}, {1u, 16384u}})
        for (const float fov : {1e-4f, 1.0f, 90.0f, 179.0f}) {
            scene.camera.vertical_fov = fov;
            const RenderSettings settings{
                .width = width, .height = height, .samples = 1, .estimator = probe("camera_rays"), .backend = GetParam()};
            const FilmImage film = render(scene, settings);
            const uvec2 key = seed_key(test_seed(settings.seed));
            for (uint32_t pixel = 0; pixel < film.pixels.size(); ++pixel) {
                const auto u = numbers_of_state(next_state(start_state(pixel, 0, {key.x, key.y})));
                const double x = pixel % width + u[0], y = pixel / width + u[1];
                const dvec3 expected = direction_of(scene.camera, width, height, x, y);
                const double error = glm::distance(dvec3(film.pixels[pixel].sum), expected);
                if (error < rounding) {
                    largest_error = std::max(largest_error, error);
                    continue;
                }
                const double pixel_size = std::max(glm::distance(direction_of(scene.camera, width, height, x + 1, y), expected),
                                                   glm::distance(direction_of(scene.camera, width, height, x, y + 1), expected));
                largest_part = std::max(largest_part, error / pixel_size);
                ASSERT_LT(error, pixel_size / 512) << width << " x " << height << ", " << fov << " degrees, pixel " << pixel;
            }
        }
    char text[64];
    std::snprintf(text, sizeof text, "%.2g rad or %.2g of a pixel", largest_error, largest_part);
    RecordProperty("largest_error_of_a_direction", text);
    std::printf("  directions are off by up to %s\n", text);
}

// A white floor under a white sky shows exactly 1 from any angle, and less if the next ray hits the floor again or starts below
// it.
TEST_P(HardCamera, GrazingViewsLoseNoLight) {
    double lost = 0, pixels = 0;
    for (const double degrees : {89.0, 89.9, 89.99, 89.999, 89.9999})
        for (const bool is_turned : {false, true}) {
            const auto height = static_cast<float>(std::cos(glm::radians(degrees)));
            Scene scene = make_scene({diffuse_material(vec3(1))}, {{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}});
            scene.camera = {.position = {-0.9f, -0.3f, height}, .target = {0, 0, 0}, .up = {0, 0, 1}, .vertical_fov = 1e-5f};
            if (is_turned) {
                const vec3 x = glm::normalize(vec3(2, 1, 0.5f)), y = glm::normalize(vec3(-1, 2, 0));
                const mat3 turn(x, y, glm::cross(x, y));
                for (vec3& position : scene.positions) position = turn * position;
                scene.camera.position = turn * scene.camera.position;
                scene.camera.up = turn[2];
            }
            scene.background = vec3(1);
            RenderSettings settings{.width = 64, .height = 64, .samples = 4};
            settings.estimator = chapter_estimator(chapter_named("cosine_sampling"));
            settings.backend = GetParam();
            for (const FilmPixel& pixel : render(scene, settings).pixels) {
                lost += pixel.sum.r != 4;
                ++pixels;
            }
            EXPECT_EQ(lost, 0) << degrees << (is_turned ? " degrees, turned" : " degrees");
        }
    RecordProperty("pixels_that_lose_light", out_of(lost, pixels));
}

}  // namespace
}  // namespace lab
