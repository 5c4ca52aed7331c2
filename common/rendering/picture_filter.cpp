#include "rendering/picture_filter.h"

#include <algorithm>

#include "files/project_folder.h"

namespace lab {
namespace {

// As large as a film, to be copied from one, but bound as a whole.
MemoryNeed film_need(uvec2 size) {
    MemoryNeed need = Film::memory_need(size.x, size.y);
    need.what = "pixels that a filter reads";
    need.is_seen_in_parts = false;
    return need;
}

MemoryNeed pixel_need(uvec2 size) {
    return {"pixels being filtered", size_t{size.x} * size.y * sizeof(FilterPixel), vk::BufferUsageFlagBits::eStorageBuffer};
}

}  // namespace

std::vector<MemoryNeed> PictureFilter::memory_needs(uvec2 image_size) {
    std::vector<MemoryNeed> needs(FILTER_FILM_COUNT + 1, film_need(image_size));
    needs.resize(needs.size() + 2, pixel_need(image_size));
    return needs;
}

PictureFilter::PictureFilter(const Device& device, const Estimator& estimator, const FilterChoice& filter, uvec2 image_size)
    : device_(&device),
      passes_(filter.passes),
      filtered_film_(device, film_need(image_size)),
      pixels_{Buffer(device, pixel_need(image_size)), Buffer(device, pixel_need(image_size))} {
    Binding films{.index = BINDING_FILTER_FILMS, .type = vk::DescriptorType::eStorageBuffer};
    for (uint32_t i = 0; i < FILTER_FILM_COUNT; ++i)
        films.buffers.push_back(storage_binding(0, films_.emplace_back(device, film_need(image_size))).buffers.front());
    const ShaderSource source{.file = project_folder() / "shaders/engine/filter.comp",
                              .defines = {filter.define},
                              .named_includes = named_includes(estimator),
                              .replacements = estimator.replacements};
    for (size_t i = 0; i < 2; ++i)
        kernels_.emplace_back(device, source,
                              std::vector<Binding>{films, storage_binding(BINDING_FILM, filtered_film_),
                                                   storage_binding(BINDING_FILTER_INPUT, pixels_[1 - i]),
                                                   storage_binding(BINDING_FILTER_OUTPUT, pixels_[i])},
                              sizeof(FilterParameters));
}

void PictureFilter::run_step(FilterParameters parameters, uint32_t number) {
    constexpr uint32_t blocks_per_dispatch = 512;  // short dispatches keep driver watchdogs quiet
    const uint32_t blocks = count_blocks(parameters.image_size);
    for (uint32_t block = 0; block < blocks; block += blocks_per_dispatch) {
        parameters.first_block = block;
        device_seconds_ += device_->submit([&](const vk::raii::CommandBuffer& commands) {
            kernels_[number % 2].record(commands, &parameters, std::min(blocks - block, blocks_per_dispatch));
        });
    }
}

void PictureFilter::set(uint32_t film, const FilmImage& image) {
    size_ = {image.width, image.height};
    films_[film].write(image.pixels.data(), image.pixels.size() * sizeof(FilmPixel));
}

void PictureFilter::set(uint32_t film, const Film& image) {
    size_ = {image.width(), image.height()};
    films_[film].copy(image.pixels());
}

FilmImage PictureFilter::apply() {
    FilmImage result{size_.x, size_.y, std::vector<FilmPixel>(size_t{size_.x} * size_.y)};
    FilterParameters parameters{.image_size = size_, .first_block = 0, .step = 0, .pass = 0};
    device_seconds_ = 0;
    uint32_t number = 0;
    const auto run = [&](uint32_t step) {
        parameters.step = step;
        run_step(parameters, number++);
    };
    run(FILTER_STEP_INPUT);
    run(FILTER_STEP_SMOOTH);
    for (; parameters.pass < passes_; ++parameters.pass) run(FILTER_STEP_PASS);
    run(FILTER_STEP_PICTURE);
    filtered_film_.read(result.pixels.data(), result.pixels.size() * sizeof(FilmPixel));
    return result;
}

}  // namespace lab
