#include "rendering/denoiser.h"

#include <cmath>

#include "clock.h"
#include "platform.h"

namespace lab {
namespace {

// The parameters of a render that shows what needs no bounce.
RenderParameters without_bounces(RenderParameters parameters) {
    parameters.max_path_length = 0;
    parameters.splat_unit = 0;
    return parameters;
}

// The same for views. Their noise must be independent of the picture's, or no half could judge what both have in common.
RenderParameters parameters_of_views(RenderParameters parameters) {
    parameters.seed_key = ~parameters.seed_key;
    return without_bounces(parameters);
}

// A view along the same camera rays, through smooth glass.
Estimator view_of(Estimator estimator, const char* define) {
    estimator.defines.insert(estimator.defines.end(), {define, "BEHIND_GLASS"});
    return observed_by("view.glsl", std::move(estimator));
}

}  // namespace

std::vector<MemoryNeed> Denoiser::memory_needs(uvec2 image_size) {
    std::vector<MemoryNeed> needs = PictureFilter::memory_needs(image_size);
    for (int i = 0; i < 3; ++i)
        for (MemoryNeed& need : Renderer::memory_needs(image_size)) needs.push_back(std::move(need));
    return needs;
}

Denoiser::Denoiser(const Device& device, const SceneBackend& scene_backend, const Estimator& estimator,
                   const FilterChoice& filter, const RenderParameters& parameters)
    : parameters_(without_bounces(parameters)),
      emission_renderer_(device, scene_backend, estimator, parameters_),
      albedo_renderer_(device, scene_backend, view_of(estimator, "VIEW_ALBEDO"), parameters_of_views(parameters)),
      normal_renderer_(device, scene_backend, view_of(estimator, "VIEW_NORMALS"), parameters_of_views(parameters)),
      filter_(device, estimator, filter, parameters.image_size) {}

void Denoiser::restart(const RenderParameters& parameters) {
    parameters_ = without_bounces(parameters);
    emission_renderer_.restart(parameters_);
    albedo_renderer_.restart(parameters_of_views(parameters));
    normal_renderer_.restart(parameters_of_views(parameters));
    kept_.clear();
    film_cost_ = filter_cost_ = {};
}

void Denoiser::keep(const FilmImage& film) { kept_.insert_or_assign(film.min_samples(), film); }

const FilmImage* Denoiser::film_before(const FilmImage& film) const {
    const uint32_t samples = film.min_samples();
    const FilmImage* best = nullptr;
    double nearest = INFINITY;
    for (const auto& [earlier, kept] : kept_) {
        const double distance = std::abs(0.5 * samples - earlier);
        if (earlier / 2 == 0 || earlier / 2 >= samples / 2 || kept.exceeds(earlier) || distance >= nearest) continue;
        best = &kept;
        nearest = distance;
    }
    return best;
}

void Denoiser::render(uint32_t film, Renderer& renderer, uint32_t samples) {
    const auto start = Clock::now();
    const double cpu_start = processor_seconds(), device_start = renderer.device_seconds();
    while (renderer.advance(samples)) {
    }
    filter_.set(film, renderer.film());
    film_cost_.seconds += seconds_since(start);
    film_cost_.device_seconds += renderer.device_seconds() - device_start;
    film_cost_.cpu_seconds += processor_seconds() - cpu_start;
}

Denoiser::Cost Denoiser::cost() const {
    return {film_cost_.seconds + filter_cost_.seconds, film_cost_.device_seconds + filter_cost_.device_seconds,
            film_cost_.cpu_seconds + filter_cost_.cpu_seconds};
}

FilmImage Denoiser::filter(const FilmImage& film) {
    const FilmImage& before = *film_before(film);
    render(FILM_ALBEDO, albedo_renderer_, feature_samples);
    render(FILM_NORMALS, normal_renderer_, feature_samples);
    if (emission_renderer_.samples() > before.min_samples()) emission_renderer_.restart(parameters_);
    render(FILM_EMISSION_BEFORE, emission_renderer_, before.min_samples());
    render(FILM_EMISSION, emission_renderer_, film.min_samples());
    const auto start = Clock::now();
    const double cpu_start = processor_seconds();
    filter_.set(FILM_BEFORE, before);
    filter_.set(FILM_NOW, film);
    FilmImage filtered = filter_.apply();
    filter_cost_ = {seconds_since(start), filter_.device_seconds(), processor_seconds() - cpu_start};
    kept_.erase(kept_.begin(), kept_.find(before.min_samples()));  // later films have more samples
    return filtered;
}

}  // namespace lab
