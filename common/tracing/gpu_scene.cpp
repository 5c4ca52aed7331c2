#include "tracing/gpu_scene.h"

#include "scene/light_table.h"

namespace lab {

template <typename T>
void GpuScene::add_buffer(const Device& device, uint32_t binding, const std::vector<T>& data,
                          vk::BufferUsageFlags usage) {
    buffers_.emplace_back(device, std::span<const T>(data), usage);
    bindings_.push_back(storage_binding(binding, buffers_.back()));
    bytes_[binding] = buffers_.back().size();
}

GpuScene::GpuScene(const Device& device, const Scene& scene, LightSampling light_sampling) : scene_(&scene) {
    const SceneFeatures features = features_of(scene);
    defines_ = features.defines();
    buffers_.reserve(8);  // the bindings refer to the buffers
    // The driver builds its acceleration structure from these two.
    vk::BufferUsageFlags usage = vk::BufferUsageFlagBits::eStorageBuffer;
    if (device.has_acceleration_structures())
        usage |= vk::BufferUsageFlagBits::eAccelerationStructureBuildInputReadOnlyKHR |
                 vk::BufferUsageFlagBits::eShaderDeviceAddress;
    add_buffer(device, BINDING_POSITIONS, scene.positions, usage);
    add_buffer(device, BINDING_TRIANGLES, scene.triangles, usage);
    add_buffer(device, BINDING_TRIANGLE_MATERIALS, scene.triangle_materials);
    add_buffer(device, BINDING_MATERIALS, scene.materials);
    if (features.vertex_normals) add_buffer(device, BINDING_NORMALS, scene.normals);
    if (features.textures) add_buffer(device, BINDING_TEXTURE_COORDINATES, scene.texture_coordinates);
    if (features.transforms) add_buffer(device, BINDING_INSTANCES, scene.instances);
    if (features.area_lights && light_sampling == LightSampling::on) {
        add_buffer(device, BINDING_LIGHT_TRIANGLES, build_light_table(scene));
        defines_.emplace_back("FEATURE_LIGHT_SAMPLING");
    }
    add_images(device, features);
}

void GpuScene::add_images(const Device& device, const SceneFeatures& features) {
    const auto bind = [&](uint32_t binding, size_t first_image) {
        bindings_.push_back({.index = binding, .type = vk::DescriptorType::eCombinedImageSampler});
        for (size_t i = first_image; i < images_.size(); ++i) {
            bindings_.back().images.push_back(images_[i].info());
            bytes_[binding] += images_[i].bytes();
        }
    };
    if (features.textures) {
        for (const auto& texture : scene_->textures)
            images_.emplace_back(device, texture.width, texture.height, vk::Format::eR8G8B8A8Unorm,
                                 std::as_bytes(std::span(texture.pixels)));
        bind(BINDING_TEXTURES, 0);
        defines_.push_back("TEXTURE_COUNT " + std::to_string(scene_->textures.size()));
    }
    if (features.light_probe) {
        // Four channels: few devices have images of three floats. 32 bits, since a sun is brighter than 16
        // bits hold.
        const Image& probe = *scene_->light_probe;
        std::vector<float> rgba;
        rgba.reserve(probe.pixels.size() / 3 * 4);
        for (size_t i = 0; i < probe.pixels.size(); i += 3)
            rgba.insert(rgba.end(), {probe.pixels[i], probe.pixels[i + 1], probe.pixels[i + 2], 1.0f});
        const size_t first = images_.size();
        images_.emplace_back(device, probe.width, probe.height, vk::Format::eR32G32B32A32Sfloat,
                             std::as_bytes(std::span(rgba)));
        bind(BINDING_LIGHT_PROBE, first);
    }
}

}  // namespace lab
