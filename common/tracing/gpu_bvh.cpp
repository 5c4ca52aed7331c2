#include "tracing/gpu_bvh.h"

namespace lab {

template <typename T>
GpuBvh::Texels::Texels(const Device& device, const LargeArray<T>& data)
    : buffer(device, std::span<const T>(data), vk::BufferUsageFlagBits::eUniformTexelBuffer),
      view(device.handle(),
           vk::BufferViewCreateInfo({}, buffer.handle(), vk::Format::eR32G32B32A32Uint, 0, VK_WHOLE_SIZE)) {}

MemoryNeed GpuBvh::memory_need(uint64_t triangle_count) {
    return {"triangles of all instances", triangle_count * sizeof(BvhTriangle),
            vk::BufferUsageFlagBits::eUniformTexelBuffer};
}

GpuBvh::GpuBvh(const Device& device, const Bvh& bvh)
    : nodes_(device, bvh.nodes),
      triangles_(device, bvh.triangles),
      max_stack_entries_(bvh.max_stack_entries),
      build_seconds_(bvh.build_seconds) {}

std::vector<Binding> GpuBvh::bindings() const {
    const auto binding = [](uint32_t index, const Texels& texels) {
        return Binding{
            .index = index, .type = vk::DescriptorType::eUniformTexelBuffer, .texel_views = {*texels.view}};
    };
    return {binding(BINDING_BVH_NODES, nodes_), binding(BINDING_BVH_TRIANGLES, triangles_)};
}

std::vector<std::string> GpuBvh::defines() const {
    return {"BVH_STACK_SIZE " + std::to_string(max_stack_entries_)};
}

}  // namespace lab
