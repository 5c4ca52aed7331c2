// Films made by hand, and scenes whose pictures are filtered.
#pragma once
#include "rendering/denoiser.h"
#include "statistics/error_metrics.h"
#include "support/render.h"

namespace lab {

// One of chapter 16's filters.
FilterChoice filter_named(const std::string& name);

// What a filter reads. The surfaces are white, look the same everywhere and shine nowhere; the pixels have 16 samples.
struct MadeFilms {
    static constexpr uint32_t samples = 16;
    explicit MadeFilms(uint32_t size);

    // Sets the means of a pixel's halves, and the variance of these means that a filter will find.
    void set(uint32_t x, uint32_t y, const std::array<vec3, 2>& means, float variance);
    FilmPixel& pixel(uint32_t film, uint32_t x, uint32_t y) { return films[film].pixels[size_t{y} * films[film].width + x]; }
    FilmImage filter(const std::string& name) const;

    std::array<FilmImage, FILTER_FILM_COUNT> films;
};

// The same light at the same place, seen so often and with this difference of the halves.
FilmPixel film_pixel(uint32_t samples, const vec3& first_half, const vec3& second_half);

// Renders a scene with chapter 16, and filters it.
struct Denoised {
    FilmImage raw, filtered;
    FilterError estimate;  // without a reference
};
class DenoisedScene {
  public:
    DenoisedScene(Scene scene, const RenderSettings& settings, const std::string& filter);
    Denoised render(uint32_t seed);

  private:
    Scene scene_;
    RenderSettings settings_;
    GpuScene gpu_scene_;
    std::unique_ptr<SceneBackend> scene_backend_;
    Renderer renderer_;
    Denoiser denoiser_;
};

}  // namespace lab
