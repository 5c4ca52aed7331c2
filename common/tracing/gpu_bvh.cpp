#include "tracing/gpu_bvh.h"

#include <algorithm>

namespace lab {
namespace {

using Usage = vk::BufferUsageFlagBits;

// Many devices read texel buffers faster, but some limit them to 65536 texels.
Usage usage_for(const Device& device, size_t bytes) {
    const size_t texels = largest_visible(device, Usage::eUniformTexelBuffer),
                 storage = largest_visible(device, Usage::eStorageBuffer);
    return bytes > texels && storage > texels ? Usage::eStorageBuffer : Usage::eUniformTexelBuffer;
}

template <typename T>
size_t bytes_of(const LargeArray<T>& data) {
    return std::span<const T>(data).size_bytes();
}

}  // namespace

template <typename T>
GpuBvh::Texels::Texels(const Device& device, const LargeArray<T>& data, Usage usage)
    : buffer(device, std::span<const T>(data), usage) {
    if (usage == Usage::eUniformTexelBuffer)
        view = {device.handle(), vk::BufferViewCreateInfo({}, buffer.handle(), vk::Format::eR32G32B32A32Uint, 0, VK_WHOLE_SIZE)};
}

void GpuBvh::require_room(const Device& device, const Scene& scene) {
    const size_t bytes = countable_triangles(scene) * sizeof(BvhTriangle);
    const MemoryNeed need{"triangles of all instances", bytes, usage_for(device, bytes)};
    require_memory(device, {&need, 1});
}

GpuBvh::GpuBvh(const Device& device, const Bvh& bvh)
    : usage_(usage_for(device, std::max(bytes_of(bvh.nodes), bytes_of(bvh.triangles)))),
      nodes_(device, bvh.nodes, usage_),
      triangles_(device, bvh.triangles, usage_),
      stack_size_(bvh.stack_size()),
      build_seconds_(bvh.build_seconds) {}

std::vector<Binding> GpuBvh::bindings() const {
    const auto binding = [&](uint32_t index, const Texels& texels) {
        if (usage_ == Usage::eStorageBuffer) return storage_binding(index, texels.buffer);
        return Binding{.index = index, .type = vk::DescriptorType::eUniformTexelBuffer, .texel_views = {*texels.view}};
    };
    return {binding(BINDING_BVH_NODES, nodes_), binding(BINDING_BVH_TRIANGLES, triangles_)};
}

std::vector<std::string> GpuBvh::defines() const {
    std::vector<std::string> defines{"BVH_STACK_SIZE " + std::to_string(stack_size_)};
    if (usage_ == Usage::eStorageBuffer) defines.emplace_back("BVH_IN_STORAGE_BUFFERS");
    return defines;
}

}  // namespace lab
