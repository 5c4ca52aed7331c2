// Our bounding volume hierarchy on the device, laid out as shaders/engine/trace_ray/bvh.glsl declares it.
#pragma once
#include "gpu/compute_kernel.h"
#include "tracing/bvh.h"

namespace lab {

class GpuBvh {
  public:
    // Checks, before minutes of building, whether the device can hold the scene's triangles. Throws UserError for more than the
    // tree can address, DeviceFailure for more than fit.
    static void require_room(const Device& device, const Scene& scene);

    // Throws DeviceFailure if the device cannot hold or address it. The device must outlive the result.
    GpuBvh(const Device& device, const Bvh& bvh);

    // BINDING_BVH_NODES and BINDING_BVH_TRIANGLES, and defines for the shader.
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
    uint32_t stack_size_;
    double build_seconds_;
};

}  // namespace lab
