// Sums the samples of all pixels on the device, exactly enough for 10^7 samples per pixel.
#pragma once
#include "film/film_image.h"
#include "gpu/compute_kernel.h"

namespace lab {

// Number of blocks of pixels that cover an image, as in shaders/engine/blocks.glsl.
uint32_t count_blocks(uvec2 image_size);

// The part of the film that is bound: all of it, unless that is more than the device can bind.
struct FilmWindow {
    uint32_t first_pixel;  // index, row by row
    uint32_t end_block;    // blocks from the requested one up to this one are in it
    uint32_t offset() const { return first_pixel * uint32_t{sizeof(FilmPixel)}; }  // in bytes
};

class Film {
  public:
    // Memory of a film of this size.
    static MemoryNeed memory_need(uint32_t width, uint32_t height);
    // Pixels of the largest film that a device can hold.
    static size_t max_pixels(const DeviceDescription& device);

    // Starts without samples. A window has at most `max_window` bytes, and room for a row of blocks and 128 pixels.
    Film(const Device& device, uint32_t width, uint32_t height, size_t max_window = SIZE_MAX);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    // Binding of a window, at an offset that dispatches give.
    Binding binding() const;
    FilmWindow window_from(uint32_t block) const;

    void clear();
    // Clears the film and gives it a size of at most the first number of pixels.
    void resize(uint32_t width, uint32_t height);
    FilmImage read() const;
    void write(const FilmImage& image);  // of the same size

  private:
    uint32_t width_;
    uint32_t height_;
    Buffer buffer_;
    size_t window_size_;  // bytes
};

}  // namespace lab
