#include "support/filters.h"

#include <algorithm>
#include <cmath>

#include "support/gpu_test.h"

namespace lab {

FilterChoice filter_named(const std::string& name) {
    const Chapter chapter = load_chapter(chapter_named("denoising"));
    const auto choice = std::ranges::find_if(chapter.choices, &ChapterChoice::is_filter);
    Options options;
    const auto& values = choice->values;
    options.estimator.choices[choice->name] =
        static_cast<size_t>(std::ranges::find(values, name, &std::pair<std::string, std::string>::first) - values.begin());
    return filter_of(chapter, options);
}

FilmPixel film_pixel(uint32_t samples, const vec3& first_half, const vec3& second_half) {
    const float half = 0.5f * static_cast<float>(samples);
    return {.sum = half * (first_half + second_half),
            .compensation = vec3(0),
            .difference = half * (first_half - second_half),
            .sample_count = samples,
            .invalid_count = 0};
}

MadeFilms::MadeFilms(uint32_t size) {
    for (FilmImage& film : films)
        film = {size, size, std::vector<FilmPixel>(size_t{size} * size, film_pixel(samples, vec3(0), vec3(0)))};
    for (const uint32_t film : {FILM_BEFORE, FILM_EMISSION_BEFORE})
        for (FilmPixel& pixel : films[film].pixels) pixel.sample_count = samples / 2;
    for (FilmPixel& pixel : films[FILM_ALBEDO].pixels) pixel = film_pixel(samples, vec3(1), vec3(1));
}

void MadeFilms::set(uint32_t x, uint32_t y, const std::array<vec3, 2>& means, float variance) {
    const vec3 gain(std::sqrt(variance));  // of the second half of the samples: as many as before, so the variance is its square
    pixel(FILM_NOW, x, y) = film_pixel(samples, means[0], means[1]);
    pixel(FILM_BEFORE, x, y) = film_pixel(samples / 2, means[0] - gain, means[1] - gain);
}

FilmImage MadeFilms::filter(const std::string& name) const {
    const FilmImage& now = films[FILM_NOW];
    const Estimator estimator = chapter_estimator(chapter_named("denoising"));
    PictureFilter filter(test_device(), estimator, filter_named(name), {now.width, now.height});
    for (uint32_t i = 0; i < films.size(); ++i) filter.set(i, films[i]);
    return filter.apply();
}

DenoisedScene::DenoisedScene(Scene scene, const RenderSettings& settings, const std::string& filter)
    : scene_(std::move(scene)),
      settings_(settings),
      gpu_scene_(make_gpu_scene(scene_, settings)),
      scene_backend_(settings.backend->build(test_device(), gpu_scene_)),
      renderer_(test_device(), *scene_backend_, settings.estimator, make_parameters(scene_, settings)),
      denoiser_(test_device(), *scene_backend_, settings.estimator, filter_named(filter), make_parameters(scene_, settings)) {}

Denoised DenoisedScene::render(uint32_t seed) {
    settings_.seed = seed;
    const RenderParameters parameters = make_parameters(scene_, settings_);
    renderer_.restart(parameters);
    denoiser_.restart(parameters);
    while (renderer_.advance(settings_.samples / 2)) {
    }
    denoiser_.keep(renderer_.film().read());
    while (renderer_.advance(settings_.samples)) {
    }
    Denoised result{.raw = renderer_.film().read(), .filtered = {}, .estimate = {}};
    result.filtered = denoiser_.filter(result.raw);
    result.estimate = estimate_filter_error(result.filtered, result.raw);
    return result;
}

}  // namespace lab
