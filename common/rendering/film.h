// The film collects the samples of all pixels on the device and keeps them exactly enough for 10^7 samples a
// pixel.
#pragma once
#include "film/film_image.h"
#include "gpu/compute_kernel.h"

namespace lab {

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
