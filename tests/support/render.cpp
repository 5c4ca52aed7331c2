#include "support/render.h"

#include <algorithm>
#include <cstdlib>

#include "files/project_folder.h"
#include "rendering/options.h"
#include "rendering/settings.h"
#include "support/gpu_test.h"

namespace lab {
Scene load_shipped_scene(const std::string& file) { return load_scene(project_folder() / "assets" / "scenes" / file); }

Estimator chapter_estimator(const std::string& chapter) {
    const Chapter own = load_chapter(chapter);
    const char* copy = std::getenv("LAB_TEST_COPY");
    const Chapter tested = copy ? load_chapter(copy) : own;
    return estimator_of(tested.title == own.title ? tested : own);
}

Estimator every_hit_estimator() { return {project_folder() / "chapters/04_splitting/solutions/split_every_hit.glsl"}; }

Estimator view_estimator(const std::string& view, const std::string& chapter) {
    Options options;
    options.image.view = &*std::find_if(views().begin(), views().end(), [&](const View& v) { return v.name == view; });
    return make_estimator(load_chapter(chapter), options);
}

Backend fastest_backend() {
    const DeviceDescription& device = test_device().description();
    return device.kind == "CPU" && is_supported(native_backend, device) ? native_backend : compute_backend;
}

namespace {

// The abilities of an estimator's chapter; none for other estimators.
Chapter chapter_of(const Estimator& estimator) {
    const auto& file = estimator.observed.empty() ? estimator.file : estimator.observed;
    const std::string name = file.parent_path().filename().string();
    return std::ranges::count(chapter_folders(), name) > 0 ? load_chapter(name) : Chapter{};
}

}  // namespace

RenderParameters make_parameters(const Scene& scene, const RenderSettings& settings) {
    RenderParameters parameters = default_parameters(scene, {settings.width, settings.height});
    parameters.seed_key = seed_key(test_seed(settings.seed));
    parameters.first_sample = settings.first_sample;
    parameters.max_path_length = settings.max_path_length;
    parameters.only_path_length = settings.only_path_length;
    parameters.splitting_factor = settings.splitting_factor;
    parameters.roulette_start = settings.roulette_start;
    parameters.survival_cap = settings.survival_cap;
    parameters.survival_weight = settings.survival_weight;
    parameters.splat_unit = splat_unit_of(scene, settings.strategy, chapter_of(settings.estimator).handles);
    return parameters;
}

bool samples_probe(const Estimator& estimator) { return chapter_of(estimator).handles.light_probe_sampling; }

GpuScene make_gpu_scene(const Scene& scene, const RenderSettings& settings) {
    return {test_device(), scene, settings.strategy, chapter_of(settings.estimator).handles};
}

SceneRenderer::SceneRenderer(const Scene& scene, const RenderSettings& settings)
    : gpu_scene_(make_gpu_scene(scene, settings)),
      scene_backend_(settings.backend->build(test_device(), gpu_scene_)),
      renderer_(test_device(), *scene_backend_, settings.estimator, make_parameters(scene, settings), {},
                settings.max_film_window) {}

Rendering SceneRenderer::render(const RenderSettings& settings) {
    renderer_.set_dispatch_seconds(settings.dispatch_seconds);
    renderer_.restart(make_parameters(gpu_scene_.scene(), settings));
    while (renderer_.advance(settings.samples)) {
    }
    Rendering rendering{renderer_.film().read(), renderer_.rays()};
    EXPECT_EQ(rendering.film.invalid_samples(), 0u);
    EXPECT_EQ(rendering.film.min_samples(), settings.samples);
    return rendering;
}

FilmImage render(const Scene& scene, const RenderSettings& settings) {
    return SceneRenderer(scene, settings).render(settings).film;
}

Batches render_batches(const Scene& scene, const RenderSettings& settings, uint32_t count) {
    Batches batches{.width = settings.width, .height = settings.height, .images = {}, .rays = {}};
    SceneRenderer renderer(scene, settings);
    for (uint32_t i = 0; i < count; ++i) {
        RenderSettings batch = settings;
        batch.seed += i << 16;
        const auto [film, rays] = renderer.render(batch);
        auto& image = batches.images.emplace_back();
        for (const FilmPixel& pixel : film.pixels)
            image.push_back((glm::dvec3(pixel.sum) + glm::dvec3(pixel.compensation)) / static_cast<double>(settings.samples));
        batches.rays.push_back(static_cast<double>(rays) / settings.samples / static_cast<double>(image.size()));
    }
    return batches;
}

Image Batches::mean_image() const {
    Image image{width, height, {}};
    for (size_t i = 0; i < images.front().size(); ++i) {
        glm::dvec3 sum(0);
        for (const auto& batch : images) sum += batch[i];
        for (int channel = 0; channel < 3; ++channel)
            image.pixels.push_back(static_cast<float>(sum[channel] / static_cast<double>(images.size())));
    }
    return image;
}

std::vector<double> Batches::means(int channel, uvec2 corner, uvec2 size) const {
    std::vector<double> means;
    for (const auto& image : images) {
        double sum = 0;
        for (uint32_t y = corner.y; y < corner.y + size.y; ++y)
            for (uint32_t x = corner.x; x < corner.x + size.x; ++x) sum += image[size_t{y} * width + x][channel];
        means.push_back(sum / size.x / size.y);
    }
    return means;
}

vec3 radiance_at(const FilmImage& film, uint32_t x, uint32_t y) {
    const FilmPixel& pixel = film.pixels[size_t{y} * film.width + x];
    return pixel.sum / static_cast<float>(pixel.sample_count);
}

std::vector<double> pixel_means(const FilmImage& film, int channel) {
    std::vector<double> means;
    for (const FilmPixel& pixel : film.pixels)
        means.push_back((double{pixel.sum[channel]} + double{pixel.compensation[channel]}) / pixel.sample_count);
    return means;
}

void OnEachBackend::SetUp() {
    if (!is_supported(GetParam(), test_device().description())) GTEST_SKIP() << "the device lacks this backend";
}

std::string backend_name(const testing::TestParamInfo<Backend>& info) {
    return instance_name(to_string(info.param), info.param == query_backend ? Run::with_all : Run::always);
}

std::string own_backend_name(const testing::TestParamInfo<Backend>& info) {
    return instance_name(to_string(info.param), info.param == compute_backend ? Run::always : Run::with_all);
}

std::string chapter_name(const testing::TestParamInfo<std::string>& info) { return "chapter_" + info.param; }

std::string own_estimator_name(const testing::TestParamInfo<std::string>& info) {
    return instance_name(chapter_name(info), repeats_another(info.param) ? Run::with_all : Run::always);
}

}  // namespace lab
