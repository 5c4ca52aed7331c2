// The same samples give the same image, no matter how a render is cut into dispatches.
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "files/project_folder.h"
#include "film/film_file.h"
#include "support/dielectric_scenes.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

// A box with a lamp, so that pixels differ.
Scene lit_box() {
    Scene scene = closed_box(diffuse_material({0.7f, 0.5f, 0.3f}));
    scene.materials.push_back(diffuse_material(vec3(0.2f), {5, 6, 7}));
    scene.triangle_materials.back() = 1;
    return scene;
}

class Determinism : public OnEachChapter {
  protected:
    // The image size is not a multiple of the block size.
    RenderSettings settings() const {
        RenderSettings settings{.width = 53, .height = 37, .samples = 24, .max_path_length = 5};
        settings.estimator = chapter_estimator(GetParam());
        return settings;
    }
    // With glass if it can send light from lamps to any pixel.
    const Scene scene = has_light_paths(GetParam()) ? room_with_box(dielectric_material(1.5f)) : lit_box();
};
// Whether it has a loop over samples of its own, or paths of its own, which such a loop keeps from one bounce to the next.
bool has_own_loop(const std::string& chapter) {
    const auto folder = project_folder() / "chapters" / chapter;
    return exists(folder / "sample_loop.glsl") || exists(folder / "extend_path.glsl");
}

// A default run has those, and one of those with the same paths.
INSTANTIATE_TEST_SUITE_P(Chapters, Determinism, testing::ValuesIn(all_chapters), [](const auto& chapter) {
    return has_own_loop(chapter.param) ? chapter_name(chapter) : own_estimator_name(chapter);
});

bool are_identical(const FilmImage& a, const FilmImage& b) {
    return a.pixels.size() == b.pixels.size() &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(FilmPixel)) == 0;
}

// Positive floats are ordered like their bits, so a difference of bits counts ulps.
void expect_within_2_ulp(const Image& a, const Image& b) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    for (size_t i = 0; i < a.pixels.size(); ++i)
        ASSERT_LE(std::abs(std::bit_cast<int32_t>(a.pixels[i]) - std::bit_cast<int32_t>(b.pixels[i])), 2)
            << "number " << i << ": " << a.pixels[i] << " and " << b.pixels[i];
}

std::filesystem::path temporary_file(const std::string& name) {
    return std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + name);
}

TEST_P(Determinism, DispatchesOfAnyLengthGiveTheSameImage) {
    RenderSettings cut = settings(), whole = settings();
    cut.dispatch_seconds = 1e-9;  // one block and one sample per pixel in every dispatch
    whole.dispatch_seconds = 10;
    EXPECT_TRUE(are_identical(render(scene, cut), render(scene, whole)));
}

// Both for pixels shared by several threads, with more samples than the buffer holds until they are added, and for pixels with a
// thread each.
TEST(Submissions, OfManySamplesGiveTheSameImage) {
    for (const auto& [size, samples] : {std::pair{uvec2(64, 64), 2000u}, std::pair{uvec2(768, 768), 8u}}) {
        RenderSettings whole{.width = size.x, .height = size.y, .samples = samples};
        whole.estimator = {project_folder() / "tests" / "shaders" / "random_radiance.glsl"};
        RenderSettings cut = whole;
        whole.dispatch_seconds = 100;
        cut.dispatch_seconds = 1e-3;
        EXPECT_TRUE(are_identical(render(lit_box(), cut), render(lit_box(), whole)));
    }
}

// A film that shaders see in parts, as with large films on devices that bind little memory: for images whose pixels several
// threads share, and for one with a thread per pixel. The last part is smaller than the others.
TEST(Submissions, OfPartsOfTheFilmGiveTheSameImage_all) {
    for (const Backend backend : all_backends) {
        if (!is_supported(backend, test_device().description())) continue;
        for (const auto& size : {uvec2(53, 37), uvec2(520, 536)}) {
            RenderSettings whole{.width = size.x, .height = size.y, .samples = 3, .max_path_length = 2};
            whole.backend = backend;
            RenderSettings parts = whole;
            parts.max_film_window = 2 * BLOCK_HEIGHT * size.x * sizeof(FilmPixel) + 300;
            EXPECT_TRUE(are_identical(render(lit_box(), parts), render(lit_box(), whole)))
                << to_string(backend) << ", " << size.x << "x" << size.y;
        }
    }
}

// With a renderer made for a large image: restarted with a small one, it still uses one thread per pixel.
FilmImage render_with_a_thread_for_each_pixel(const Scene& scene, const RenderSettings& settings) {
    const GpuScene gpu_scene = make_gpu_scene(scene, settings);
    const auto scene_backend = settings.backend->build(test_device(), gpu_scene);
    RenderSettings large = settings;
    large.width = large.height = 640;
    Renderer renderer(test_device(), *scene_backend, settings.estimator, make_parameters(scene, large));
    renderer.restart(make_parameters(scene, settings));
    renderer.set_dispatch_seconds(settings.dispatch_seconds);
    while (renderer.advance(settings.samples)) {
    }
    return renderer.film().read();
}

TEST_P(Determinism, ThreadsThatShareAPixelGiveTheSameImage) {
    // Dispatches of several samples against dispatches of a single one, whatever the device's speed.
    RenderSettings shared = settings(), alone = settings();
    shared.dispatch_seconds = 10;
    alone.dispatch_seconds = 1e-9;
    const FilmImage expected = render_with_a_thread_for_each_pixel(scene, alone);
    EXPECT_TRUE(are_identical(expected, render(scene, shared)));
    for (const uint32_t threads : {1u, 2u}) {  // each renders several samples, one after another
        shared.estimator.max_threads_per_pixel = threads;
        EXPECT_TRUE(are_identical(expected, render(scene, shared))) << threads;
    }
}

TEST_P(Determinism, ResumedRenderEqualsAnUninterruptedOne) {
    // With a film that shaders see in parts: the checkpoint contains the samples of all parts.
    const size_t two_rows_of_blocks = 2 * BLOCK_HEIGHT * settings().width * sizeof(FilmPixel);
    const GpuScene gpu_scene = make_gpu_scene(scene, settings());
    const auto scene_backend = compute_backend->build(test_device(), gpu_scene);
    const auto make_renderer = [&] {
        return Renderer(test_device(), *scene_backend, settings().estimator, make_parameters(scene, settings()), {},
                        two_rows_of_blocks);
    };
    // Interrupted in mid-pass, when some pixels have one sample more than others.
    Renderer interrupted = make_renderer();
    interrupted.set_dispatch_seconds(1e-9);
    for (int dispatch = 0; dispatch < 100; ++dispatch) interrupted.advance(settings().samples);
    const auto file = temporary_file("interrupted.exr");
    write_film(file, interrupted.film().read(), {});
    const FilmFile checkpoint = read_film(file);
    std::filesystem::remove(file);
    // With light paths the film is that of whole passes.
    const bool is_uneven = checkpoint.image.pixels.front().sample_count != checkpoint.image.pixels.back().sample_count;
    EXPECT_NE(is_uneven, has_light_paths(GetParam()));

    Renderer resumed = make_renderer();
    resumed.resume(checkpoint.image);
    while (resumed.advance(settings().samples)) {
    }
    EXPECT_EQ(resumed.film().read().min_samples(), settings().samples);
    expect_within_2_ulp(resumed.film().read().mean(), render(scene, settings()).mean());
}

TEST_P(Determinism, PathLengthsAddUpToTheImage) {
    const FilmImage whole = render(scene, settings());
    std::vector<glm::dvec3> sums(whole.pixels.size());
    for (uint32_t length = 0; length <= settings().max_path_length; ++length) {
        RenderSettings part = settings();
        part.only_path_length = static_cast<int>(length);
        const FilmImage film = render(scene, part);
        for (size_t i = 0; i < sums.size(); ++i)
            sums[i] += glm::dvec3(film.pixels[i].sum) + glm::dvec3(film.pixels[i].compensation);
    }
    for (size_t i = 0; i < sums.size(); ++i)
        for (int channel = 0; channel < 3; ++channel)
            ASSERT_NEAR(sums[i][channel], whole.pixels[i].sum[channel], 1e-6 * sums[i][channel]);
}

// Chapter 10 schedules the work of threads differently, and changes nothing else.
class PathRegeneration : public OnEachBackend {
  protected:
    // Renders with the chapter before it and with its own.
    template <typename Render>
    std::array<FilmImage, 2> render_both(RenderSettings settings, const Render& render_one) const {
        settings.backend = GetParam();
        const std::array chapters{chapter_named("low_discrepancy_points"), chapter_named("path_regeneration")};
        std::array<FilmImage, 2> films;
        for (size_t i = 0; i < films.size(); ++i) {
            settings.estimator = chapter_estimator(chapters[i]);
            films[i] = render_one(settings);
        }
        return films;
    }

    // To the bit, except on GPU pipelines: the driver of an NVIDIA H200 compiles copies of a loop that round differently, and 5 %
    // of the pixels differed by up to 3e-6.
    static void expect_same(const FilmImage& a, const FilmImage& b, const std::string& name) {
        const bool is_cpu = test_device().physical().getProperties().deviceType == vk::PhysicalDeviceType::eCpu;
        if (GetParam() != pipeline_backend || is_cpu) {
            EXPECT_TRUE(are_identical(a, b)) << name;
            return;
        }
        ASSERT_EQ(a.pixels.size(), b.pixels.size());
        for (size_t i = 0; i < a.pixels.size(); ++i)
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(a.pixels[i].sum[channel], b.pixels[i].sum[channel], 1e-5f * a.pixels[i].sum[channel])
                    << name << ", pixel " << i;
    }

    void expect_the_image_of_chapter_nine(const std::string& name) const;
};
INSTANTIATE_TEST_SUITE_P(Backends, PathRegeneration, testing::ValuesIn(all_backends), own_backend_name);

void PathRegeneration::expect_the_image_of_chapter_nine(const std::string& name) const {
    const Scene scene = load_shipped_scene(name + ".json");
    RenderSettings settings{.width = 40, .height = 24, .samples = 21, .max_path_length = 30, .dispatch_seconds = 10};
    // One thread renders all samples of a pixel.
    const auto whole =
        render_both(settings, [&](const RenderSettings& s) { return render_with_a_thread_for_each_pixel(scene, s); });
    expect_same(whole[0], whole[1], name);
    // With dispatches of one block and one sample there is nothing to regenerate.
    settings.dispatch_seconds = 1e-9;
    const auto cut = render_both(settings, [&](const RenderSettings& s) { return render(scene, s); });
    for (const FilmImage& film : cut) expect_same(whole[0], film, name);
}

TEST_P(PathRegeneration, GivesTheImageOfChapterNine) { expect_the_image_of_chapter_nine("glass"); }
TEST_P(PathRegeneration, GivesTheImageOfChapterNineInOtherScenes_all) {
    for (const char* name : {"cornell_box", "studio"}) expect_the_image_of_chapter_nine(name);
}

// Several threads share a pixel, and each renders several samples of it.
TEST_P(PathRegeneration, OfThreadsThatShareAPixelGivesTheImageOfChapterNine) {
    const Scene scene = load_shipped_scene("cornell_box.json");
    const RenderSettings settings{.width = 200, .height = 136, .samples = 40, .max_path_length = 5, .dispatch_seconds = 10};
    const auto [before, now] = render_both(settings, [&](const RenderSettings& s) { return render(scene, s); });
    expect_same(before, now, "cornell_box");
}

}  // namespace
}  // namespace lab
