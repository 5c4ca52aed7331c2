#include "rendering/film.h"

#include <algorithm>

namespace lab {
namespace {

// Alignment of windows, in bytes: whole pixels and a multiple of 256 bytes, the most that any device requires.
constexpr size_t alignment = 64 * sizeof(FilmPixel);

}  // namespace

uint32_t count_blocks(uvec2 image_size) {
    return ((image_size.x + BLOCK_WIDTH - 1) / BLOCK_WIDTH) * ((image_size.y + BLOCK_HEIGHT - 1) / BLOCK_HEIGHT);
}

MemoryNeed Film::memory_need(uint32_t width, uint32_t height) {
    const size_t bytes = size_t{width} * height * sizeof(FilmPixel);
    return {.what = "image's pixels",
            .bytes = (bytes + alignment - 1) / alignment * alignment,
            .usage = vk::BufferUsageFlagBits::eStorageBuffer,
            .is_seen_in_parts = true};
}

size_t Film::max_pixels(const DeviceDescription& device) {
    return std::min(device.largest_buffer, device.memory) / alignment * (alignment / sizeof(FilmPixel));
}

Film::Film(const Device& device, uint32_t width, uint32_t height, size_t max_window)
    : width_(width),
      height_(height),
      buffer_(device, memory_need(width, height)),
      window_size_(std::min(
          {buffer_.size(), max_window / alignment * alignment, device.limits().maxStorageBufferRange / alignment * alignment})) {
    clear();
}

Binding Film::binding() const {
    return buffer_binding(BINDING_FILM, vk::DescriptorType::eStorageBufferDynamic, buffer_, window_size_);
}

FilmWindow Film::window_from(uint32_t block) const {
    const uint32_t blocks_per_row = count_blocks({width_, 1});
    const size_t first_row = block / blocks_per_row * BLOCK_HEIGHT;
    const size_t offset = std::min(first_row * width_ * sizeof(FilmPixel) / alignment * alignment, buffer_.size() - window_size_);
    const size_t end_row = (offset + window_size_) / sizeof(FilmPixel) / width_;
    return {static_cast<uint32_t>(offset / sizeof(FilmPixel)),
            end_row < height_ ? static_cast<uint32_t>(end_row) / BLOCK_HEIGHT * blocks_per_row : count_blocks({width_, height_})};
}

void Film::clear() { buffer_.clear(); }

void Film::resize(uint32_t width, uint32_t height) {
    width_ = width;
    height_ = height;
    clear();
}

FilmImage Film::read() const {
    FilmImage image{width_, height_, std::vector<FilmPixel>(size_t{width_} * height_)};
    buffer_.read(image.pixels.data(), image.pixels.size() * sizeof(FilmPixel));
    return image;
}

void Film::write(const FilmImage& image) { buffer_.write(image.pixels.data(), image.pixels.size() * sizeof(FilmPixel)); }

}  // namespace lab
