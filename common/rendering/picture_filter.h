// Runs a chapter's filter.glsl over a picture.
#pragma once
#include <array>

#include "gpu/compute_kernel.h"
#include "rendering/film.h"
#include "rendering/settings.h"

namespace lab {

class PictureFilter {
  public:
    static std::vector<MemoryNeed> memory_needs(uvec2 image_size);

    // `estimator` is that of the chapter, whose folder has filter.glsl. Throws UserError if it does not compile. The device must
    // outlive the filter.
    PictureFilter(const Device& device, const Estimator& estimator, const FilterChoice& filter, uvec2 image_size);

    // What the filter reads as this film: FILM_NOW or another constant of shaders/interface.h. All must have the same size, at
    // most the one above.
    void set(uint32_t film, const FilmImage& image);
    void set(uint32_t film, const Film& image);  // one without light paths
    // Filters these films, which must all be set. In each half of each pixel, FILM_NOW must have samples that FILM_BEFORE has
    // not. The halves of the result are the filtered halves.
    FilmImage apply();
    double device_seconds() const { return device_seconds_; }  // of the last picture

  private:
    void run_step(FilterParameters parameters, uint32_t number);

    const Device* device_;
    uint32_t passes_;
    uvec2 size_{0};
    std::vector<Buffer> films_;
    Buffer filtered_film_;
    std::array<Buffer, 2> pixels_;        // each step reads one of them and writes the other
    std::vector<ComputeKernel> kernels_;  // for even and for odd steps
    double device_seconds_ = 0;
};

}  // namespace lab
