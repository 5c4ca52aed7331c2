// The `compute` backend: our own bounding volume hierarchy in a compute shader.
#include "tracing/backends.h"
#include "tracing/bvh.h"

namespace lab {
namespace {

// An array as 16-byte texels: texel buffers are faster to read than storage buffers on many devices.
struct TexelArray {
    template <typename T>
    TexelArray(const Device& device, const std::vector<T>& data)
        : buffer(device, std::span<const T>(data), vk::BufferUsageFlagBits::eUniformTexelBuffer),
          view(device.handle(),
               vk::BufferViewCreateInfo({}, buffer.handle(), vk::Format::eR32G32B32A32Uint, 0, VK_WHOLE_SIZE)) {}
    Buffer buffer;
    vk::raii::BufferView view;

    Binding binding(uint32_t index) const {
        return {.index = index, .type = vk::DescriptorType::eUniformTexelBuffer, .texel_views = {*view}};
    }
};

class ComputeBackend : public AccelerationStructure {
  public:
    ComputeBackend(const Device& device, const GpuScene& scene)
        : ComputeBackend(device, scene, build_bvh(world_triangles(scene.scene()))) {}

    std::unique_ptr<Tracer> make_tracer(const Estimator& estimator,
                                        std::span<const Binding> bindings) const override {
        ShaderSource source = shader_source("render.comp", ShaderStage::compute, *scene_, estimator);
        source.defines.push_back("BVH_STACK_SIZE " + std::to_string(max_stack_entries_));
        const Binding bvh[] = {nodes_.binding(BINDING_BVH_NODES), triangles_.binding(BINDING_BVH_TRIANGLES)};
        return make_compute_tracer(*device_, source, join({bindings, scene_->bindings(), bvh}));
    }

    size_t bytes() const override { return nodes_.buffer.size() + triangles_.buffer.size(); }
    double build_seconds() const override { return build_seconds_; }

  private:
    ComputeBackend(const Device& device, const GpuScene& scene, const Bvh& bvh)
        : device_(&device),
          scene_(&scene),
          max_stack_entries_(bvh.max_stack_entries),
          build_seconds_(bvh.build_seconds),
          nodes_(device, bvh.nodes),
          triangles_(device, bvh.triangles) {}

    const Device* device_;
    const GpuScene* scene_;
    uint32_t max_stack_entries_;
    double build_seconds_;
    TexelArray nodes_;
    TexelArray triangles_;
};

}  // namespace

std::unique_ptr<AccelerationStructure> build_compute_backend(const Device& device, const GpuScene& scene) {
    return std::make_unique<ComputeBackend>(device, scene);
}

}  // namespace lab
