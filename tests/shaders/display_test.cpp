// shaders/engine/display.comp: the screen shows what to_display() of film/film_image.h computes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "support/dielectric_scenes.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "viewer/screen.h"

namespace lab {
namespace {

// Radiance from far below to far above the displayable range, with different sample counts, some invalid samples and some
// negative values.
FilmImage make_film(uint32_t width, uint32_t height) {
    FilmImage film{width, height, {}};
    for (uint32_t i = 0; i < width * height; ++i) {
        FilmPixel pixel{};
        pixel.sample_count = 1 + i % 7;
        const float value = std::exp2(static_cast<float>(i) / static_cast<float>(width * height) * 24 - 16);
        pixel.sum = static_cast<float>(pixel.sample_count) * vec3(value, 0.5f * value, 1.7f * value);
        pixel.compensation = 0.01f * pixel.sum;
        if (i % 11 == 0) pixel.sum = vec3(0);
        if (i % 17 == 0) pixel.sum *= -1.0f;
        if (i % 13 == 0) pixel.invalid_count = 1;
        film.pixels.push_back(pixel);
    }
    return film;
}

std::vector<uint8_t> show(Film& film, const std::shared_ptr<StorageImage>& picture, DisplayTransform transform, float exposure) {
    const DisplayPass pass(test_device(), film, picture);
    test_device().submit([&](const vk::raii::CommandBuffer& commands) { pass.record(commands, transform, exposure); });
    return picture->read();
}

TEST(Display, AgreesWithTheSavedPictureToOneStepOfEightBits) {
    const FilmImage image = make_film(61, 35);  // not multiples of a block
    Film film(test_device(), image.width, image.height);
    film.write(image);
    const auto picture = std::make_shared<StorageImage>(test_device(), image.width, image.height);
    for (const auto transform : {DisplayTransform::exposure, DisplayTransform::maximum, DisplayTransform::as_is})
        for (const float exposure : {0.0f, -3.5f, 6.0f}) {
            const auto shown = show(film, picture, transform, exposure);
            const Texture expected = to_display(image, transform, exposure);
            int largest = 0;
            for (size_t i = 0; i < shown.size(); ++i)
                largest = std::max(largest, std::abs(int{shown[i]} - int{expected.pixels[i]}));
            EXPECT_LE(largest, 1) << "transform " << static_cast<int>(transform) << ", exposure " << exposure;
        }
    const FilmImage after = film.read();
    EXPECT_EQ(std::memcmp(after.pixels.data(), image.pixels.data(), image.pixels.size() * sizeof(FilmPixel)), 0)
        << "showing a film must not change it";
}

// As on a device with small bindings: the largest value is the maximum over all parts.
TEST(Display, ShowsAFilmThatIsSeenInParts) {
    FilmImage image = make_film(61, 35);
    std::ranges::rotate(image.pixels, image.pixels.begin() + 1000);
    Film whole(test_device(), image.width, image.height),
        parts(test_device(), image.width, image.height, (BLOCK_HEIGHT * image.width + 128) * sizeof(FilmPixel));
    whole.write(image);
    parts.write(image);
    ASSERT_GT(parts.window_from(count_blocks({image.width, image.height}) - 1).first_pixel, 0u);
    for (const uvec2 size : {uvec2(61, 35), uvec2(183, 70), uvec2(30, 20)})
        for (const auto transform : {DisplayTransform::exposure, DisplayTransform::maximum}) {
            const auto of_whole = std::make_shared<StorageImage>(test_device(), size.x, size.y),
                       of_parts = std::make_shared<StorageImage>(test_device(), size.x, size.y);
            EXPECT_EQ(show(parts, of_parts, transform, 0), show(whole, of_whole, transform, 0));
        }
}

TEST(Display, KeepsThePictureWhereThereAreNoSamplesYet) {
    FilmImage image = make_film(16, 16);
    Film film(test_device(), 16, 16);
    film.write(image);
    const auto picture = std::make_shared<StorageImage>(test_device(), 16, 16);
    const auto before = show(film, picture, DisplayTransform::exposure, 0);
    for (size_t i = 0; i < image.pixels.size(); ++i)
        if (i >= 128)
            image.pixels[i] = FilmPixel{};
        else
            image.pixels[i].sum *= 2.0f;
    film.write(image);
    const auto after = show(film, picture, DisplayTransform::exposure, 0);
    EXPECT_NE(std::memcmp(after.data(), before.data(), 4 * 128), 0);
    EXPECT_EQ(std::memcmp(after.data() + 4 * 128, before.data() + 4 * 128, 4 * 128), 0);
}

// In the middle of a pass, light that its samples have sent to other pixels would be divided by their own number of samples.
TEST(Display, ShowsLightPathsOfWholePasses) {
    const Scene scene = room_with_box(dielectric_material(1.5f));
    const RenderSettings settings{.estimator = chapter_estimator(chapter_named("light_paths"))};
    const GpuScene gpu_scene = make_gpu_scene(scene, settings);
    const auto scene_backend = settings.backend->build(test_device(), gpu_scene);
    Renderer renderer(test_device(), *scene_backend, settings.estimator, make_parameters(scene, settings));
    const auto picture = std::make_shared<StorageImage>(test_device(), settings.width, settings.height);
    const auto shown = [&] { return show(renderer.film(), picture, DisplayTransform::exposure, 0); };
    const auto expect_film = [&] {
        const Texture expected = to_display(renderer.film().read(), DisplayTransform::exposure, 0);
        const auto pixels = shown();
        for (size_t i = 0; i < pixels.size(); ++i) ASSERT_NEAR(pixels[i], expected.pixels[i], 1) << i;
    };
    renderer.set_dispatch_seconds(1e-9);  // one block at a time
    while (renderer.advance(1)) {
    }
    expect_film();
    const auto before = shown();
    ASSERT_TRUE(renderer.advance(2));
    ASSERT_GT(renderer.samples(), 1);
    EXPECT_EQ(shown(), before);
    while (renderer.advance(2)) {
    }
    expect_film();
    EXPECT_NE(shown(), before);
}

TEST(Display, EnlargesAReducedFilm) {
    const FilmImage image = make_film(8, 4);
    Film film(test_device(), 32, 16);
    film.resize(8, 4);
    film.write(image);
    const auto picture = std::make_shared<StorageImage>(test_device(), 32, 16);
    const auto shown = show(film, picture, DisplayTransform::exposure, 0);
    const Texture small = to_display(image, DisplayTransform::exposure, 0);
    for (size_t y = 0; y < 16; ++y)
        for (size_t x = 0; x < 32; ++x)
            for (size_t channel = 0; channel < 4; ++channel)
                ASSERT_NEAR(shown[4 * (32 * y + x) + channel], small.pixels[4 * (8 * (y / 4) + x / 4) + channel], 1)
                    << x << ", " << y;
}

}  // namespace
}  // namespace lab
