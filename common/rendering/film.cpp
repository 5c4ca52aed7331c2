#include "rendering/film.h"

#include <algorithm>

#include "parallel.h"

namespace lab {
namespace {

// Alignment of windows, in bytes: whole pixels and a multiple of 256 bytes, the most that any device requires.
constexpr size_t alignment = 64 * sizeof(FilmPixel);

// Adds what light paths sent to a pixel.
void add_splats(FilmPixel& pixel, const uint32_t* words, double unit) {
    const auto half = [&](const uint32_t* word) {
        const auto number = [&](int channel) {
            return unit * static_cast<double>(uint64_t{word[2 * channel + 1]} << 32 | word[2 * channel]);
        };
        return glm::dvec3(number(0), number(1), number(2));
    };
    const glm::dvec3 first = half(words), second = half(words + 6);
    set_sum(pixel, sum_of(pixel) + first + second);
    pixel.difference += vec3(first - second);
    pixel.invalid_count = std::min(pixel.invalid_count + words[SPLAT_WORDS - 1], pixel.sample_count);
}

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

std::vector<MemoryNeed> Film::memory_needs_of_splats(uint32_t width, uint32_t height) {
    const MemoryNeed splats{.what = "pixels of light paths",
                            .bytes = size_t{width} * height * SPLAT_WORDS * sizeof(uint32_t),
                            .usage = vk::BufferUsageFlagBits::eStorageBuffer};
    return {memory_need(width, height), splats, splats};
}

size_t Film::max_pixels(const DeviceDescription& device) {
    return std::min(device.largest_buffer, device.memory) / alignment * (alignment / sizeof(FilmPixel));
}

Film::Film(const Device& device, uint32_t width, uint32_t height, size_t max_window, float splat_unit)
    : width_(width),
      height_(height),
      buffer_(device, memory_need(width, height)),
      window_size_(std::min(
          {buffer_.size(), max_window / alignment * alignment, device.limits().maxStorageBufferRange / alignment * alignment})),
      splat_unit_(splat_unit) {
    if (splat_unit > 0) {
        const std::vector<MemoryNeed> needs = memory_needs_of_splats(width, height);
        kept_.emplace(device, needs[0]);
        splats_.emplace(device, needs[1]);
        kept_splats_.emplace(device, needs[2]);
    }
    clear();
}

std::vector<Binding> Film::bindings() const { return bind(buffer_, splats_); }

std::vector<Binding> Film::bindings_of_picture() const { return splats_ ? bind(*kept_, kept_splats_) : bindings(); }

std::vector<Binding> Film::bind(const Buffer& pixels, const std::optional<Buffer>& splats) const {
    std::vector<Binding> bindings{buffer_binding(BINDING_FILM, vk::DescriptorType::eStorageBufferDynamic, pixels, window_size_)};
    if (splats) bindings.push_back(storage_binding(BINDING_SPLATS, *splats));
    return bindings;
}

FilmWindow Film::window_from(uint32_t block) const {
    const uint32_t blocks_per_row = count_blocks({width_, 1});
    const size_t first_row = block / blocks_per_row * BLOCK_HEIGHT;
    const size_t offset = std::min(first_row * width_ * sizeof(FilmPixel) / alignment * alignment, buffer_.size() - window_size_);
    const size_t end_row = (offset + window_size_) / sizeof(FilmPixel) / width_;
    return {static_cast<uint32_t>(offset / sizeof(FilmPixel)),
            end_row < height_ ? static_cast<uint32_t>(end_row) / BLOCK_HEIGHT * blocks_per_row : count_blocks({width_, height_})};
}

void Film::clear() {
    buffer_.clear();
    if (splats_) splats_->clear();
    keep();
}

void Film::keep() {
    if (!splats_) return;
    kept_->copy(buffer_);
    kept_splats_->copy(*splats_);
}

void Film::resize(uint32_t width, uint32_t height) {
    width_ = width;
    height_ = height;
    clear();
}

FilmImage Film::read() const {
    FilmImage image{width_, height_, std::vector<FilmPixel>(size_t{width_} * height_)};
    (splats_ ? *kept_ : buffer_).read(image.pixels.data(), image.pixels.size() * sizeof(FilmPixel));
    if (splats_) {
        std::vector<uint32_t> words(image.pixels.size() * SPLAT_WORDS);
        kept_splats_->read(words.data(), words.size() * sizeof(uint32_t));
        in_parallel(image.pixels.size(), pixels_per_piece, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) add_splats(image.pixels[i], &words[i * SPLAT_WORDS], double{splat_unit_});
        });
    }
    return image;
}

void Film::write(const FilmImage& image) {
    if (splats_) splats_->clear();
    buffer_.write(image.pixels.data(), image.pixels.size() * sizeof(FilmPixel));
    keep();
}

}  // namespace lab
