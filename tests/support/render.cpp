#include "support/render.h"

#include <algorithm>

#include "app/options.h"
#include "support/gpu_test.h"

namespace lab {

Estimator chapter_estimator(const std::string& chapter) {
    return {project_folder() / "chapters" / chapter / "path_trace.glsl"};
}

Estimator view_estimator(const std::string& view) {
    const auto found =
        std::find_if(views().begin(), views().end(), [&](const View& v) { return v.name == view; });
    return {project_folder() / "shaders" / "view.glsl", {found->define}};
}

RenderParameters make_parameters(const Scene& scene, const RenderSettings& settings) {
    return {.camera = make_camera(scene.camera, settings.width, settings.height),
            .image_size = {settings.width, settings.height},
            .seed_key = seed_key(settings.seed),
            .first_sample = settings.first_sample,
            .max_path_length = settings.max_path_length,
            .only_path_length = settings.only_path_length,
            .background = scene.background,
            .probe_rotation = scene.probe_rotation};
}

FilmImage render(const Scene& scene, const RenderSettings& settings) {
    const Device& device = test_device();
    const GpuScene gpu_scene(device, scene);
    const auto acceleration_structure = build_acceleration_structure(settings.backend, device, gpu_scene);
    Renderer renderer(device, *acceleration_structure, settings.estimator, make_parameters(scene, settings));
    renderer.set_dispatch_seconds(settings.dispatch_seconds);
    while (renderer.advance(settings.samples)) {
    }
    FilmImage film = renderer.film().read();
    EXPECT_EQ(film.invalid_samples(), 0u);
    EXPECT_EQ(film.min_samples(), settings.samples);
    return film;
}

vec3 radiance_at(const FilmImage& film, uint32_t x, uint32_t y) {
    const FilmPixel& pixel = film.pixels[size_t{y} * film.width + x];
    return pixel.sum / static_cast<float>(pixel.sample_count);
}

std::vector<double> pixel_means(const FilmImage& film, int channel) {
    std::vector<double> means;
    for (const FilmPixel& pixel : film.pixels)
        means.push_back((double{pixel.sum[channel]} + double{pixel.compensation[channel]}) /
                        pixel.sample_count);
    return means;
}

void OnEachBackend::SetUp() {
    if (!test_device().description().supports(GetParam())) GTEST_SKIP() << "the device lacks this backend";
}

std::string backend_name(const testing::TestParamInfo<Backend>& info) { return to_string(info.param); }

std::string chapter_name(const testing::TestParamInfo<std::string>& info) { return "chapter_" + info.param; }

}  // namespace lab
