// Runs a chapter's filter.glsl over a picture.
#pragma once
#include <array>

#include "film/film_image.h"
#include "gpu/compute_kernel.h"
#include "rendering/settings.h"

namespace lab {

// What a filter reads, by FILM_NOW and the other constants of shaders/interface.h.
using FilterFilms = std::array<const FilmImage*, FILTER_FILM_COUNT>;

class PictureFilter {
  public:
    static std::vector<MemoryNeed> memory_needs(uvec2 image_size);

    // `estimator` is that of the chapter, whose folder has filter.glsl. Throws UserError if it does not compile. The device must
    // outlive the filter.
    PictureFilter(const Device& device, const Estimator& estimator, const FilterChoice& filter, uvec2 image_size);

    // All films have the same size, at most the one above. In each half of each pixel, FILM_NOW must have samples that
    // FILM_BEFORE has not. The halves of the result are the filtered halves.
    FilmImage apply(const FilterFilms& films);
    double device_seconds() const { return device_seconds_; }  // of the last picture

  private:
    void run_step(FilterParameters parameters, uint32_t number);

    const Device* device_;
    uint32_t passes_;
    std::vector<Buffer> films_;
    Buffer filtered_film_;
    std::array<Buffer, 2> pixels_;        // each step reads one of them and writes the other
    std::vector<ComputeKernel> kernels_;  // for even and for odd steps
    double device_seconds_ = 0;
};

}  // namespace lab
