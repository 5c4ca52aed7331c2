#include "tracing/gpu_scene.h"

#include <algorithm>
#include <numeric>

#include "error.h"
#include "scene/light_table.h"

namespace lab {

namespace {

// An array to be copied to the device.
struct Array {
    uint32_t binding;
    std::span<const std::byte> data;
};

// Throws DeviceFailure for more textures than shaders can bind. The light probe and both arrays of the backend `compute` count as
// images, too, and every other binding takes a slot.
void require_visible(const Device& device, size_t texture_count) {
    const auto& limits = device.limits();
    const size_t most = std::min(std::max(limits.maxPerStageDescriptorSampledImages, 3u) - 3,
                                 std::max(limits.maxPerStageResources, BINDING_COUNT) - BINDING_COUNT);
    if (texture_count > most)
        throw DeviceFailure("the scene has " + std::to_string(texture_count) + " textures, and shaders of the device see " +
                            std::to_string(most) + " at most: join some of them");
}

size_t bytes_of(const Image& probe) { return probe.pixels.size() / 3 * 4 * sizeof(float); }

}  // namespace

std::string to_string(Strategy strategy) {
    return strategy == Strategy::both ? "both" : strategy == Strategy::light ? "light" : "bounces";
}

GpuScene::GpuScene(const Device& device, const Scene& scene, Strategy strategy, bool samples_probe, bool handles_microfacets)
    : scene_(&scene) {
    const SceneFeatures features = features_of(scene);
    defines_ = features.defines();
    std::vector<Array> arrays;
    const auto add = [&](const char* name, uint32_t binding, const auto& data, vk::BufferUsageFlags usage = {}) {
        arrays.push_back({binding, std::as_bytes(std::span(data))});
        memory_needs_.push_back({name, arrays.back().data.size(), usage | vk::BufferUsageFlagBits::eStorageBuffer});
    };
    // The driver builds its acceleration structure from the first two.
    vk::BufferUsageFlags build_input;
    if (device.has_extension(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME))
        build_input =
            vk::BufferUsageFlagBits::eAccelerationStructureBuildInputReadOnlyKHR | vk::BufferUsageFlagBits::eShaderDeviceAddress;
    add("positions", BINDING_POSITIONS, scene.positions, build_input);
    add("triangles", BINDING_TRIANGLES, scene.triangles, build_input);
    add("materials of triangles", BINDING_TRIANGLE_MATERIALS, scene.triangle_materials);
    LightTable lights{.triangles = {}, .materials = scene.materials};
    samples_probe = samples_probe && features.light_probe && strategy != Strategy::bounces;
    const bool samples_triangles = features.area_lights && strategy != Strategy::bounces;
    const float probe_probability = !samples_probe ? 0 : !samples_triangles ? 1 : LIGHT_PROBE_PROBABILITY;
    if (samples_triangles) {
        lights = build_light_table(scene, 1 - probe_probability);
        add("light triangles", BINDING_LIGHT_TRIANGLES, lights.triangles);
        defines_.emplace_back("FEATURE_LIGHT_TRIANGLES");
    }
    std::vector<ProbeCell> probe_cells;
    if (samples_probe) {
        probe_cells = build_probe_table(*scene.light_probe, probe_probability);
        add("cells of the light probe", BINDING_PROBE_CELLS, probe_cells);
        defines_.emplace_back("FEATURE_LIGHT_PROBE_CELLS");
    }
    add("materials", BINDING_MATERIALS, lights.materials);
    if (features.microfacets && handles_microfacets) {
        add("microfacets", BINDING_MICROFACETS, scene.microfacets);
        defines_.emplace_back("FEATURE_MICROFACETS");
        if (scene.multiple_scattering) defines_.emplace_back("FEATURE_MULTIPLE_SCATTERING");
    }
    if (features.vertex_normals) add("vertex normals", BINDING_NORMALS, scene.normals);
    std::vector<uvec2> texture_sizes;
    if (features.textures) {
        add("texture coordinates", BINDING_TEXTURE_COORDINATES, scene.texture_coordinates);
        for (const Texture& texture : scene.textures) texture_sizes.emplace_back(texture.width, texture.height);
        add("sizes of textures", BINDING_TEXTURE_SIZES, texture_sizes);
    }
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

    const auto add_image_need = [&](const char* name, size_t bytes, const auto& image) {
        memory_needs_.push_back({.what = name, .bytes = bytes, .image_size = {image.width, image.height}});
    };
    for (const Texture& texture : scene.textures) add_image_need("texture", texture.pixels.size(), texture);
    if (features.light_probe) add_image_need("light probe", bytes_of(*scene.light_probe), *scene.light_probe);
    require_memory(device, memory_needs_);
    require_visible(device, scene.textures.size());
    for (size_t i = 0; i < arrays.size(); ++i) {
        buffers_.emplace_back(device, arrays[i].data, memory_needs_[i].usage);
        bindings_.push_back(storage_binding(arrays[i].binding, buffers_.back()));
    }
    add_images(device, features);
}

void GpuScene::add_images(const Device& device, const SceneFeatures& features) {
    const auto add = [&](const auto& image, vk::Format format, const auto& pixels) {
        images_.emplace_back(device, image.width, image.height, format, std::as_bytes(std::span(pixels)));
        bindings_.back().images.push_back(images_.back().info());
    };
    const auto add_binding = [&](uint32_t index) {
        bindings_.push_back({.index = index, .type = vk::DescriptorType::eSampledImage});
    };
    if (features.textures) {
        add_binding(BINDING_TEXTURES);
        for (const auto& texture : scene_->textures) add(texture, vk::Format::eR8G8B8A8Unorm, texture.pixels);
        defines_.push_back("TEXTURE_COUNT " + std::to_string(scene_->textures.size()));
    }
    if (features.light_probe) {
        // Four channels, since few devices support images of three floats; 32 bits, since the sun exceeds the range of 16.
        const Image& probe = *scene_->light_probe;
        std::vector<float> rgba;
        rgba.reserve(probe.pixels.size() / 3 * 4);
        for (size_t i = 0; i < probe.pixels.size(); i += 3)
            rgba.insert(rgba.end(), {probe.pixels[i], probe.pixels[i + 1], probe.pixels[i + 2], 1.0f});
        add_binding(BINDING_LIGHT_PROBE);
        add(probe, vk::Format::eR32G32B32A32Sfloat, rgba);
    }
}

}  // namespace lab
