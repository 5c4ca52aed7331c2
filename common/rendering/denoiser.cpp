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
    : emission_renderer_(device, scene_backend, estimator, without_bounces(parameters)),
      albedo_renderer_(device, scene_backend, view_of(estimator, "VIEW_ALBEDO"), parameters_of_views(parameters)),
      normal_renderer_(device, scene_backend, view_of(estimator, "VIEW_NORMALS"), parameters_of_views(parameters)),
      filter_(device, estimator, filter, parameters.image_size) {}

void Denoiser::restart(const RenderParameters& parameters) {
    emission_renderer_.restart(without_bounces(parameters));
    albedo_renderer_.restart(parameters_of_views(parameters));
    normal_renderer_.restart(parameters_of_views(parameters));
    kept_.clear();
    emission_.clear();
    albedo_ = normals_ = {};
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

FilmImage Denoiser::render(Renderer& renderer, uint32_t samples) {
    const auto start = Clock::now();
    const double cpu_start = processor_seconds(), device_start = renderer.device_seconds();
    while (renderer.advance(samples)) {
    }
    FilmImage film = renderer.film().read();
    film_cost_.seconds += seconds_since(start);
    film_cost_.device_seconds += renderer.device_seconds() - device_start;
    film_cost_.cpu_seconds += processor_seconds() - cpu_start;
    return film;
}

Denoiser::Cost Denoiser::cost() const {
    return {film_cost_.seconds + filter_cost_.seconds, film_cost_.device_seconds + filter_cost_.device_seconds,
            film_cost_.cpu_seconds + filter_cost_.cpu_seconds};
}

const FilmImage& Denoiser::emission(uint32_t samples) {
    auto found = emission_.find(samples);
    if (found == emission_.end()) found = emission_.emplace(samples, render(emission_renderer_, samples)).first;
    return found->second;
}

FilmImage Denoiser::filter(const FilmImage& film) {
    if (albedo_.pixels.empty()) {
        albedo_ = render(albedo_renderer_, feature_samples);
        normals_ = render(normal_renderer_, feature_samples);
    }
    const FilmImage& before = *film_before(film);
    const FilmImage& emission_before = emission(before.min_samples());
    const FilmImage& emission_now = emission(film.min_samples());
    const auto start = Clock::now();
    const double cpu_start = processor_seconds();
    FilmImage filtered = filter_.apply({&film, &before, &emission_now, &emission_before, &albedo_, &normals_});
    filter_cost_ = {seconds_since(start), filter_.device_seconds(), processor_seconds() - cpu_start};
    // Later films have more samples.
    kept_.erase(kept_.begin(), kept_.find(before.min_samples()));
    emission_.erase(emission_.begin(), emission_.find(before.min_samples()));
    return filtered;
}

}  // namespace lab
