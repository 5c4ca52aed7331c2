// The `compute` backend: our own bounding volume hierarchy in a compute shader.
#include "tracing/bvh.h"
#include "tracing/tracer.h"

namespace lab {
namespace {

class ComputeTracer : public Tracer {
  public:
    ComputeTracer(const Device& device, const ShaderSource& source, std::span<const Binding> bindings)
        : kernel_(device, source, bindings, sizeof(DispatchParameters)) {}

    void record(const vk::raii::CommandBuffer& commands, const DispatchParameters& dispatch,
                uint32_t block_count) const override {
        kernel_.record(commands, &dispatch, block_count);
    }

  private:
    ComputeKernel kernel_;
};

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

class ComputeBvh : public AccelerationStructure {
  public:
    ComputeBvh(const Device& device, const GpuScene& scene)
        : ComputeBvh(device, scene, build_bvh(world_triangles(scene.scene()))) {}

    std::unique_ptr<Tracer> make_tracer(const Estimator& estimator,
                                        std::span<const Binding> bindings) const override {
        ShaderSource source{.file = project_folder() / "shaders" / "render.comp",
                            .defines = scene_->defines(),
                            .named_includes = {{"path_trace.glsl", estimator.file}}};
        source.defines.push_back("BVH_STACK_SIZE " + std::to_string(max_stack_entries_));
        source.defines.insert(source.defines.end(), estimator.defines.begin(), estimator.defines.end());
        std::vector<Binding> all(bindings.begin(), bindings.end());
        all.insert(all.end(), scene_->bindings().begin(), scene_->bindings().end());
        all.push_back(nodes_.binding(BINDING_BVH_NODES));
        all.push_back(triangles_.binding(BINDING_BVH_TRIANGLES));
        return std::make_unique<ComputeTracer>(*device_, source, all);
    }

  private:
    ComputeBvh(const Device& device, const GpuScene& scene, const Bvh& bvh)
        : device_(&device),
          scene_(&scene),
          max_stack_entries_(bvh.max_stack_entries),
          nodes_(device, bvh.nodes),
          triangles_(device, bvh.triangles) {}

    const Device* device_;
    const GpuScene* scene_;
    uint32_t max_stack_entries_;
    TexelArray nodes_;
    TexelArray triangles_;
};

}  // namespace

std::unique_ptr<AccelerationStructure> build_compute_bvh(const Device& device, const GpuScene& scene) {
    return std::make_unique<ComputeBvh>(device, scene);
}

}  // namespace lab
