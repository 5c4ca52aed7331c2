// Filters the pictures of a render: keeps what its film held earlier, and renders what else the filter needs to know.
#pragma once
#include <map>

#include "rendering/picture_filter.h"
#include "rendering/renderer.h"
#include "rendering/settings.h"

namespace lab {

// What a camera ray sees through smooth glass, on average over so many samples.
inline constexpr uint32_t feature_samples = 16;

class Denoiser {
  public:
    static std::vector<MemoryNeed> memory_needs(uvec2 image_size);

    // For a render with this estimator and these parameters. Device and acceleration structure must outlive the denoiser. Throws
    // UserError if the filter does not compile.
    Denoiser(const Device& device, const SceneBackend& scene_backend, const Estimator& estimator, const FilterChoice& filter,
             const RenderParameters& parameters);

    // Begins anew with a render of other parameters, of at most as many pixels as the first one.
    void restart(const RenderParameters& parameters);
    // Keeps the film of an unfinished render: variances come from what it gains later. Call it at every doubling of the samples.
    void keep(const FilmImage& film);
    // Whether both halves of each pixel have samples before and after some film that was kept.
    bool can_filter(const FilmImage& film) const { return film_before(film) != nullptr; }
    // The filtered film, whose halves are the filtered halves, if it can be filtered.
    FilmImage filter(const FilmImage& film);
    // What a picture needs besides its own samples: all other films of this run, and the last filtering.
    struct Cost {
        double seconds = 0, device_seconds = 0, cpu_seconds = 0;
    };
    Cost cost() const;

  private:
    // The film that was kept from which filter() takes variances; null if there is none.
    const FilmImage* film_before(const FilmImage& film) const;
    // Hands the filter a film of so many samples, which may be there already.
    void render(uint32_t film, Renderer& renderer, uint32_t samples);

    RenderParameters parameters_;  // of the emission
    Renderer emission_renderer_, albedo_renderer_, normal_renderer_;
    PictureFilter filter_;
    std::map<uint32_t, FilmImage> kept_;  // by samples
    Cost film_cost_, filter_cost_;
};

}  // namespace lab
