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
    RenderParameters parameters = default_parameters(scene, {settings.width, settings.height});
    parameters.seed_key = seed_key(settings.seed);
    parameters.first_sample = settings.first_sample;
    parameters.max_path_length = settings.max_path_length;
    parameters.only_path_length = settings.only_path_length;
    parameters.splitting_factor = settings.splitting_factor;
    parameters.roulette_start = settings.roulette_start;
    parameters.survival_cap = settings.survival_cap;
    return parameters;
}

FilmImage render(const Scene& scene, const RenderSettings& settings) {
    const Device& device = test_device();
    const GpuScene gpu_scene(device, scene, settings.light_sampling);
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
