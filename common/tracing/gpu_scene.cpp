#include "tracing/gpu_scene.h"

#include <algorithm>

#include "error.h"

namespace lab {

namespace {

// Throws DeviceFailure for more textures than shaders can bind. The light probe and both arrays of the backend `compute` count as
// images, too. Every buffer of the scene takes a slot, and so do eleven other bindings: the parameters, film, counters and the
// two outputs of chapters, the samples, the light probe, and what the backends trace rays in.
void require_visible(const Device& device, size_t texture_count, size_t buffer_count) {
    const auto& limits = device.limits();
    const size_t others = 11 + buffer_count;
    const size_t most = std::min<size_t>(std::max(limits.maxPerStageDescriptorSampledImages, 3u) - 3,
                                         std::max<size_t>(limits.maxPerStageResources, others) - others);
    if (texture_count > most)
        throw DeviceFailure("the scene has " + std::to_string(texture_count) + " textures, and shaders of the device see " +
                            std::to_string(most) + " at most: join some of them");
}

}  // namespace

GpuScene::GpuScene(const Device& device, const Scene& scene, Strategy strategy, const Capabilities& handles) : scene_(&scene) {
    const SceneArrays arrays(scene, strategy, handles);
    defines_ = arrays.defines();
    // The driver builds its acceleration structure from the first two.
    vk::BufferUsageFlags build_input;
    if (device.has_extension(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME))
        build_input =
            vk::BufferUsageFlagBits::eAccelerationStructureBuildInputReadOnlyKHR | vk::BufferUsageFlagBits::eShaderDeviceAddress;
    for (const SceneArray& array : arrays.buffers())
        memory_needs_.push_back(
            {array.name, array.data.size(),
             vk::BufferUsageFlagBits::eStorageBuffer | (memory_needs_.size() < 2 ? build_input : vk::BufferUsageFlags())});
    for (const SceneArray& image : arrays.images())
        memory_needs_.push_back({.what = image.name, .bytes = image.data.size(), .image_size = {image.width, image.height}});
    require_memory(device, memory_needs_);
    require_visible(device, scene.textures.size(), arrays.buffers().size());
    for (const SceneArray& array : arrays.buffers()) {
        buffers_.emplace_back(device, array.data, memory_needs_[buffers_.size()].usage);
        bindings_.push_back(storage_binding(array.binding, buffers_.back()));
    }
    for (const SceneArray& image : arrays.images()) {
        if (bindings_.back().index != image.binding)
            bindings_.push_back({.index = image.binding, .type = vk::DescriptorType::eSampledImage});
        const bool is_probe = image.binding == BINDING_LIGHT_PROBE;
        images_.emplace_back(device, image.width, image.height,
                             is_probe ? vk::Format::eR32G32B32A32Sfloat : vk::Format::eR8G8B8A8Unorm, image.data);
        bindings_.back().images.push_back(images_.back().info());
    }
}

}  // namespace lab
