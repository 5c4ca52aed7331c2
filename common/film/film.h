// The film collects the samples of all pixels on the device and keeps them exactly enough for 10^7 samples a
// pixel.
#pragma once
#include <vector>

#include "gpu/compute_kernel.h"
#include "image/image.h"
#include "shaders/interface.h"

namespace lab {

// The film's contents on the host: pixels row by row from the top.
struct FilmImage {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<FilmPixel> pixels;

    bool has_equal_sample_counts() const;
    uint32_t min_samples() const;                 // samples that every pixel has
    uint64_t invalid_samples() const;             // samples that were infinite or not a number
    Image mean() const;                           // mean radiance of a pixel; 0 where there are no samples
    std::array<double, 3> mean_radiance() const;  // of the whole image
};

// The samples of `whole` that came after those of `first`, an earlier state of the same film.
FilmImage samples_after(const FilmImage& first, const FilmImage& whole);

// Blocks of pixels that cover an image, as in shaders/blocks.glsl.
uint32_t count_blocks(uvec2 image_size);

class Film {
  public:
    // What a film of this size allocates.
    static MemoryNeed memory_need(uint32_t width, uint32_t height);

    // Starts without samples.
    Film(const Device& device, uint32_t width, uint32_t height);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    Binding binding() const { return storage_binding(BINDING_FILM, buffer_); }

    void clear();  // to no samples
    // To a size of at most as many pixels as the first one, without samples.
    void resize(uint32_t width, uint32_t height);
    FilmImage read() const;
    void write(const FilmImage& image);  // of the same size

  private:
    uint32_t width_;
    uint32_t height_;
    Buffer buffer_;
};

}  // namespace lab
