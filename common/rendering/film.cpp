#include "rendering/film.h"

namespace lab {

uint32_t count_blocks(uvec2 image_size) {
    return ((image_size.x + BLOCK_WIDTH - 1) / BLOCK_WIDTH) *
           ((image_size.y + BLOCK_HEIGHT - 1) / BLOCK_HEIGHT);
}

MemoryNeed Film::memory_need(uint32_t width, uint32_t height) {
    return {"image's pixels", size_t{width} * height * sizeof(FilmPixel),
            vk::BufferUsageFlagBits::eStorageBuffer};
}

Film::Film(const Device& device, uint32_t width, uint32_t height)
    : width_(width),
      height_(height),
      buffer_(device, memory_need(width, height).bytes, memory_need(width, height).usage) {
    clear();
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

void Film::write(const FilmImage& image) {
    buffer_.write(image.pixels.data(), image.pixels.size() * sizeof(FilmPixel));
}

}  // namespace lab
