// One sample of one pixel becomes infinite or NaN: it is counted and displayed, and nothing else changes.
#include <cstring>

#include "files/project_folder.h"
#include "film/film_image.h"
#include "support/gpu_test.h"
#include "support/pcg2d.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

class InvalidSamples : public OnEachBackend {
  protected:
    static constexpr uint32_t width = 21, height = 13, samples = 9, poisoned_pixel = 5 * width + 8, poisoned_sample = 4;

    // The film of samples first, ..., first + count - 1, one of which may be poisoned.
    static FilmImage render(uint32_t bits, int channel, uint32_t first = 0, uint32_t count = samples) {
        const Device& device = test_device();
        const Scene scene = closed_box(diffuse_material({0.7f, 0.5f, 0.3f}, {1, 2, 3}));
        const GpuScene gpu_scene(device, scene);
        const auto scene_backend = GetParam()->build(device, gpu_scene);
        const RenderParameters parameters = make_parameters(scene, {.width = width, .height = height, .first_sample = first});
        // The estimator starts after the two numbers for the position in the pixel.
        const RandomState state =
            next_state(start_state(poisoned_pixel, poisoned_sample, {parameters.seed_key.x, parameters.seed_key.y}));
        const auto number = [](uint32_t n) { return std::to_string(n) + "u"; };
        const Estimator estimator{project_folder() / "tests/shaders/poisoned.glsl",
                                  {"POISONED_STATE " + number(state[0]) + ", " + number(state[1]), "POISON " + number(bits),
                                   "POISONED_CHANNEL " + std::to_string(channel)}};
        Renderer renderer(device, *scene_backend, estimator, parameters);
        while (renderer.advance(count)) {
        }
        return renderer.film().read();
    }
};
INSTANTIATE_TEST_SUITE_P(Backends, InvalidSamples, testing::ValuesIn(all_backends), own_backend_name);

constexpr uint32_t quiet_nan = 0x7fc00000, signalling_nan = 0x7f800001, negative_nan = 0xffffffff, infinity = 0x7f800000,
                   negative_infinity = 0xff800000;

TEST_P(InvalidSamples, AreCountedAndAddNothing) {
    // The pixel without that sample.
    const FilmImage before = render(0, 0, 0, poisoned_sample),
                    after = render(0, 0, poisoned_sample + 1, samples - poisoned_sample - 1);
    const FilmImage clean = render(0x3f800000, 0);
    const vec3 expected = before.pixels[poisoned_pixel].sum + after.pixels[poisoned_pixel].sum;
    for (const uint32_t bits : {quiet_nan, signalling_nan, negative_nan, infinity, negative_infinity})
        for (const int channel : {0, 1, 2}) {
            const FilmImage film = render(bits, channel);
            ASSERT_EQ(film.invalid_samples(), 1u) << std::hex << bits;
            for (uint32_t i = 0; i < width * height; ++i) {
                const FilmPixel& pixel = film.pixels[i];
                ASSERT_EQ(pixel.sample_count, samples);
                if (i == poisoned_pixel) {
                    EXPECT_EQ(pixel.invalid_count, 1u);
                    EXPECT_LT(glm::distance(pixel.sum, expected), 1e-6f * glm::length(expected));
                } else {
                    ASSERT_EQ(std::memcmp(&pixel, &clean.pixels[i], sizeof pixel), 0) << "pixel " << i;
                }
            }
        }
    record("neighbours_that_change", "0 of %u", width * height - 1);
}

}  // namespace
}  // namespace lab
