#include "viewer/display_pass.h"

#include <algorithm>
#include <cmath>

#include "files/project_folder.h"

namespace lab {

DisplayPass::DisplayPass(const Device& device, const Film& film, std::shared_ptr<StorageImage> picture)
    : device_(&device),
      film_(&film),
      picture_(std::move(picture)),
      largest_value_(device, sizeof(uint32_t), vk::BufferUsageFlagBits::eStorageBuffer),
      kernel_(device, {.file = project_folder() / "shaders" / "engine/display.comp"},
              std::vector<Binding>{film.binding(),
                                   {.index = BINDING_PICTURE,
                                    .type = vk::DescriptorType::eStorageImage,
                                    .images = {picture_->info()}},
                                   storage_binding(BINDING_LARGEST_VALUE, largest_value_)},
              sizeof(DisplayParameters)) {}

void DisplayPass::record(const vk::raii::CommandBuffer& commands, DisplayTransform transform,
                         float exposure) const {
    const bool is_radiance = transform == DisplayTransform::exposure;
    DisplayParameters parameters{.film_size = {film_->width(), film_->height()},
                                 .image_size = {picture_->width(), picture_->height()},
                                 .first_film_pixel = 0,
                                 .block_count = count_blocks({picture_->width(), picture_->height()}),
                                 .scale = is_radiance ? std::exp2(exposure) : 1.0f,
                                 .is_srgb = is_radiance,
                                 .divides_by_largest = 0};
    wait_for_writes(commands);
    if (transform == DisplayTransform::maximum) {
        commands.fillBuffer(largest_value_.handle(), 0, VK_WHOLE_SIZE, 0);
        wait_for_writes(commands);
        parameters.divides_by_largest = 2;
        record_parts(commands, parameters);
        wait_for_writes(commands);
        parameters.divides_by_largest = 1;
    }
    record_parts(commands, parameters);
    wait_for_writes(commands);
}

void DisplayPass::record_parts(const vk::raii::CommandBuffer& commands, DisplayParameters parameters) const {
    const uint32_t groups = std::min(parameters.block_count, device_->limits().maxComputeWorkGroupCount[0]);
    const uint32_t film_blocks = count_blocks({film_->width(), film_->height()});
    for (uint32_t block = 0; block < film_blocks;) {
        const FilmWindow window = film_->window_from(block);
        parameters.first_film_pixel = window.first_pixel;
        kernel_.record(commands, &parameters, groups, window.offset());
        block = window.end_block;
    }
}

}  // namespace lab
