// A bounding volume hierarchy on the device, as shaders/trace_ray/bvh.glsl declares it.
#pragma once
#include "gpu/compute_kernel.h"
#include "tracing/bvh.h"

namespace lab {

class GpuBvh {
  public:
    // Of a tree, before it is built: its triangles alone.
    static MemoryNeed memory_need(const Device& device, uint64_t triangle_count);

    // Throws DeviceFailure if the device cannot hold or address it. The device must outlive the result.
    GpuBvh(const Device& device, const Bvh& bvh);

    // BINDING_BVH_NODES and BINDING_BVH_TRIANGLES, and the defines that the shader needs.
    std::vector<Binding> bindings() const;
    std::vector<std::string> defines() const;

    size_t bytes() const { return nodes_.buffer.size() + triangles_.buffer.size(); }
    double build_seconds() const { return build_seconds_; }

  private:
    // An array of 16-byte texels.
    struct Texels {
        Buffer buffer;
        vk::raii::BufferView view = nullptr;  // of a texel buffer
        template <typename T>
        Texels(const Device& device, const LargeArray<T>& data, vk::BufferUsageFlagBits usage);
    };
    vk::BufferUsageFlagBits usage_;
    Texels nodes_;
    Texels triangles_;
    uint32_t max_stack_entries_;
    double build_seconds_;
};

}  // namespace lab
