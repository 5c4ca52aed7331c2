// The film collects the samples of all pixels on the device and keeps them exactly enough for 10^7 samples a
// pixel.
#pragma once
#include "film/film_image.h"
#include "gpu/compute_kernel.h"

namespace lab {

// Blocks of pixels that cover an image, as in shaders/blocks.glsl.
uint32_t count_blocks(uvec2 image_size);

// What shaders see of a film at a time: all of it, unless that is more than a device can bind.
struct FilmWindow {
    uint32_t first_pixel;  // index, row by row
    uint32_t end_block;    // the blocks before this one are in it, from the one that was asked for
    uint32_t offset() const { return first_pixel * uint32_t{sizeof(FilmPixel)}; }  // in bytes
};

class Film {
  public:
    // What a film of this size allocates.
    static MemoryNeed memory_need(uint32_t width, uint32_t height);
    // Of the largest film that a device can hold.
    static size_t max_pixels(const DeviceDescription& device);

    // Starts without samples. A window has at most so many bytes, and room for a row of blocks.
    Film(const Device& device, uint32_t width, uint32_t height, size_t max_window = SIZE_MAX);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    // Of a window, whose offset each dispatch gives.
    Binding binding() const;
    FilmWindow window_from(uint32_t block) const;

    void clear();  // to no samples
    // To a size of at most as many pixels as the first one, without samples.
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
