// Sums the samples of all pixels on the device, accurate for up to 10^7 samples per pixel.
#pragma once
#include <optional>

#include "film/film_image.h"
#include "gpu/compute_kernel.h"

namespace lab {

// Number of pixel blocks that cover an image, as in shaders/engine/blocks.glsl.
uint32_t count_blocks(uvec2 image_size);

// The part of the film that is bound: all of it, unless it is larger than the device can bind.
struct FilmWindow {
    uint32_t first_pixel;  // index, row by row
    uint32_t end_block;    // blocks from the requested one up to this one are inside
    uint32_t offset() const { return first_pixel * uint32_t{sizeof(FilmPixel)}; }  // in bytes
};

class Film {
  public:
    // Memory for a film of this size.
    static MemoryNeed memory_need(uint32_t width, uint32_t height);
    // Memory for what light paths add to it, and for the copy that keep() makes. It is bound as a whole, since they reach any
    // pixel.
    static std::vector<MemoryNeed> memory_needs_of_splats(uint32_t width, uint32_t height);
    // Number of pixels of the largest film that a device can hold.
    static size_t max_pixels(const DeviceDescription& device);

    // Starts without samples. A window has at most `max_window` bytes; it must hold a row of blocks and 128 pixels.
    // Light paths add multiples of `splat_unit`, see SPLAT_WORDS; 0 if there are none.
    Film(const Device& device, uint32_t width, uint32_t height, size_t max_window = SIZE_MAX, float splat_unit = 0);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    // Bind a window, at an offset given with each dispatch, and what light paths add, if anything: to add samples, or to show
    // what read() returns.
    std::vector<Binding> bindings() const;
    std::vector<Binding> bindings_of_picture() const;
    float splat_unit() const { return splat_unit_; }
    FilmWindow window_from(uint32_t block) const;

    void clear();
    // Clears and resizes the film, to at most the number of pixels that it was created with.
    void resize(uint32_t width, uint32_t height);
    // With what light paths added, as it was when keep() was called last: light that samples have sent to other pixels belongs to
    // all samples together, so a picture of some of them would be wrong. Without light paths, as it is.
    FilmImage read() const;
    void keep();
    void write(const FilmImage& image);  // of the same size
    // The pixels on the device, without what light paths added.
    const Buffer& pixels() const { return buffer_; }

  private:
    std::vector<Binding> bind(const Buffer& pixels, const std::optional<Buffer>& splats) const;

    uint32_t width_;
    uint32_t height_;
    Buffer buffer_;
    size_t window_size_;  // bytes
    float splat_unit_;
    std::optional<Buffer> splats_;  // of light paths
    std::optional<Buffer> kept_, kept_splats_;
};

}  // namespace lab
