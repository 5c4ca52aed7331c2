// Renders scenes for tests.
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "app/all_backends.h"
#include "rendering/renderer.h"
#include "scene/scene.h"
#include "support/chapters.h"

namespace lab {

// The chapter's estimator, or if the environment's LAB_TEST_COPY names a copy of this chapter's folder, that of the copy.
Estimator chapter_estimator(const std::string& chapter);
Estimator every_hit_estimator();  // splits at every hit
Estimator view_estimator(const std::string& view, const std::string& chapter = all_chapters.front());

// For messages.
inline const std::array<std::string, 3> channel_names{"red", "green", "blue"};

// A scene in assets/scenes, by file name.
Scene load_shipped_scene(const std::string& file);

struct RenderSettings {
    uint32_t width = 64;
    uint32_t height = 64;
    uint32_t samples = 16;
    uint32_t max_path_length = 8;
    int only_path_length = -1;
    uint32_t seed = 1;
    uint32_t first_sample = 0;
    uint32_t splitting_factor = 1;
    uint32_t roulette_start = 1;
    float survival_cap = 0.95f;
    float survival_weight = 1;
    Strategy strategy = Strategy::both;
    Estimator estimator = chapter_estimator(all_chapters.front());
    Backend backend = compute_backend;
    double dispatch_seconds = 0.1;
    size_t max_film_window = SIZE_MAX;  // bytes
};

// For long renders: on a CPU `native`, which follows the paths of `compute` (see Parity) in half the time.
Backend fastest_backend();

RenderParameters make_parameters(const Scene& scene, const RenderSettings& settings);
// Whether an estimator belongs to a chapter that samples light probes.
bool samples_probe(const Estimator& estimator);
GpuScene make_gpu_scene(const Scene& scene, const RenderSettings& settings);

struct Rendering {
    FilmImage film;
    uint64_t rays = 0;
};

// Renders a scene repeatedly but compiles its shaders only once. The settings may differ in everything but estimator, backend,
// strategy and the film's window.
class SceneRenderer {
  public:
    SceneRenderer(const Scene& scene, const RenderSettings& settings);

    // Returns the film after all samples. Fails the test if any of them is invalid.
    Rendering render(const RenderSettings& settings);

  private:
    GpuScene gpu_scene_;
    std::unique_ptr<SceneBackend> scene_backend_;
    Renderer renderer_;
};

// Renders once.
FilmImage render(const Scene& scene, const RenderSettings& settings);

// Images rendered with different seeds: independent estimates whose spread gives the error of their mean.
struct Batches {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<std::vector<glm::dvec3>> images;  // mean radiance of each pixel, one image per batch
    std::vector<double> rays;                     // per sample, one number per batch

    // One number per batch: the mean of a channel over the image or over a rectangle of pixels.
    std::vector<double> means(int channel) const { return means(channel, {0, 0}, {width, height}); }
    std::vector<double> means(int channel, uvec2 corner, uvec2 size) const;
    Image mean_image() const;
};
// Each batch takes settings.samples samples per pixel.
Batches render_batches(const Scene& scene, const RenderSettings& settings, uint32_t count);

// Mean radiance of pixels, row by row from the top.
vec3 radiance_at(const FilmImage& film, uint32_t x, uint32_t y);

// One channel of all pixels' mean radiances. If all pixels have the same expectation they are independent estimates.
std::vector<double> pixel_means(const FilmImage& film, int channel);

// Fixture of tests to run with each backend that the device supports.
class OnEachBackend : public testing::TestWithParam<Backend> {
  protected:
    void SetUp() override;
};

using OnEachChapter = testing::TestWithParam<std::string>;

// For INSTANTIATE_TEST_SUITE_P: names the instances after their backends or chapters. Ray queries use the same structure as the
// pipeline, and Parity compares their paths, so they run only with --all. So do both of the driver's backends where
// `own_backend_name` names the instances, and chapters that repeat another one where `own_estimator_name` does.
std::string backend_name(const testing::TestParamInfo<Backend>& info);
std::string own_backend_name(const testing::TestParamInfo<Backend>& info);
std::string chapter_name(const testing::TestParamInfo<std::string>& info);
std::string own_estimator_name(const testing::TestParamInfo<std::string>& info);

}  // namespace lab
