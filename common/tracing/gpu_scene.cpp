#include "tracing/gpu_scene.h"

#include <numeric>

#include "scene/light_table.h"
#include "scene/probe_table.h"

namespace lab {

namespace {

// An array that is to be copied to the device.
struct Array {
    std::string name;
    uint32_t binding;
    std::span<const std::byte> data;
    vk::BufferUsageFlags usage;
};

size_t bytes_of(const Image& probe) { return probe.pixels.size() / 3 * 4 * sizeof(float); }

}  // namespace

GpuScene::GpuScene(const Device& device, const Scene& scene, LightSampling light_sampling) : scene_(&scene) {
    const SceneFeatures features = features_of(scene);
    defines_ = features.defines();
    std::vector<Array> arrays;
    const auto add = [&](const char* name, uint32_t binding, const auto& data,
                         vk::BufferUsageFlags usage = {}) {
        arrays.push_back(
            {name, binding, std::as_bytes(std::span(data)), usage | vk::BufferUsageFlagBits::eStorageBuffer});
    };
    // The driver builds its acceleration structure from the first two.
    vk::BufferUsageFlags build_input;
    if (device.has_acceleration_structures())
        build_input = vk::BufferUsageFlagBits::eAccelerationStructureBuildInputReadOnlyKHR |
                      vk::BufferUsageFlagBits::eShaderDeviceAddress;
    add("positions", BINDING_POSITIONS, scene.positions, build_input);
    add("triangles", BINDING_TRIANGLES, scene.triangles, build_input);
    add("materials of triangles", BINDING_TRIANGLE_MATERIALS, scene.triangle_materials);
    LightTable lights{.triangles = {}, .materials = scene.materials};
    const bool samples_probe = features.light_probe && light_sampling == LightSampling::with_probe;
    const bool samples_triangles = features.area_lights && light_sampling != LightSampling::off;
    const float probe_probability = !samples_probe ? 0 : !samples_triangles ? 1 : LIGHT_PROBE_PROBABILITY;
    if (samples_triangles) {
        lights = build_light_table(scene, 1 - probe_probability);
        add("light triangles", BINDING_LIGHT_TRIANGLES, lights.triangles);
        defines_.emplace_back("FEATURE_LIGHT_SAMPLING");
    }
    std::vector<ProbeCell> probe_cells;
    if (samples_probe) {
        probe_cells = build_probe_table(*scene.light_probe, probe_probability);
        add("cells of the light probe", BINDING_PROBE_CELLS, probe_cells);
        defines_.emplace_back("FEATURE_LIGHT_PROBE_SAMPLING");
    }
    add("materials", BINDING_MATERIALS, lights.materials);
    if (features.vertex_normals) add("vertex normals", BINDING_NORMALS, scene.normals);
    if (features.textures) add("texture coordinates", BINDING_TEXTURE_COORDINATES, scene.texture_coordinates);
    if (features.transforms) add("instances", BINDING_INSTANCES, scene.instances);
    std::vector<uint32_t> other_sides;
    if (features.double_sided) {
        other_sides.resize(scene.triangles.size());
        std::iota(other_sides.begin(), other_sides.end(), 0u);
        for (const auto& sides : scene.double_sided) {
            other_sides[sides.x] = sides.y;
            other_sides[sides.y] = sides.x;
        }
        add("other sides of triangles", BINDING_OTHER_SIDES, other_sides);
    }

    std::vector<MemoryNeed> needs;
    for (const Array& array : arrays) needs.push_back({array.name, array.data.size(), array.usage});
    for (const auto& texture : scene.textures) needs.push_back({"textures", texture.pixels.size()});
    if (features.light_probe) needs.push_back({"light probe's texels", bytes_of(*scene.light_probe)});
    require_memory(device, needs);
    buffers_.reserve(arrays.size());  // the bindings refer to the buffers
    for (const Array& array : arrays) {
        buffers_.emplace_back(device, array.data, array.usage);
        bindings_.push_back(storage_binding(array.binding, buffers_.back()));
        allocations_.push_back({array.name, array.binding, buffers_.back().size()});
    }
    add_images(device, features);
}

void GpuScene::add_images(const Device& device, const SceneFeatures& features) {
    const auto bind = [&](const char* name, uint32_t binding, size_t first_image) {
        bindings_.push_back({.index = binding, .type = vk::DescriptorType::eCombinedImageSampler});
        allocations_.push_back({name, binding, 0});
        for (size_t i = first_image; i < images_.size(); ++i) {
            bindings_.back().images.push_back(images_[i].info());
            allocations_.back().bytes += images_[i].bytes();
        }
    };
    if (features.textures) {
        for (const auto& texture : scene_->textures)
            images_.emplace_back(device, texture.width, texture.height, vk::Format::eR8G8B8A8Unorm,
                                 std::as_bytes(std::span(texture.pixels)));
        bind("textures", BINDING_TEXTURES, 0);
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
        bind("light probe", BINDING_LIGHT_PROBE, first);
    }
}

}  // namespace lab
