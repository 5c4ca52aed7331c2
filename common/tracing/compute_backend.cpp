// The `compute` backend: our own bounding volume hierarchy in a compute shader.
#include "tracing/backends.h"
#include "tracing/gpu_bvh.h"

namespace lab {
namespace {

// The tree, unless the device cannot hold it: building it in vain would take minutes.
Bvh build(const Device& device, const Scene& scene) {
    const uint64_t count = instanced_triangle_count(scene);
    const MemoryNeed need = GpuBvh::memory_need(count);
    if (count <= max_triangle_count) require_memory(device, {&need, 1});  // else world_triangles() refuses it
    return build_bvh(world_triangles(scene));
}

class ComputeBackend : public AccelerationStructure {
  public:
    ComputeBackend(const Device& device, const GpuScene& scene)
        : device_(&device), scene_(&scene), bvh_(device, build(device, scene.scene())) {}

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        ShaderSource source = shader_source("render.comp", ShaderStage::compute, *scene_, estimator);
        for (const auto& define : bvh_.defines()) source.defines.push_back(define);
        return {source};
    }

    std::unique_ptr<Tracer> make_tracer(const Estimator& estimator,
                                        std::span<const Binding> bindings) const override {
        return make_compute_tracer(*device_, shaders(estimator).front(),
                                   join({bindings, scene_->bindings(), bvh_.bindings()}));
    }

    size_t bytes() const override { return bvh_.bytes(); }
    double build_seconds() const override { return bvh_.build_seconds(); }

  private:
    const Device* device_;
    const GpuScene* scene_;
    GpuBvh bvh_;
};

}  // namespace

std::unique_ptr<AccelerationStructure> build_compute_backend(const Device& device, const GpuScene& scene) {
    return std::make_unique<ComputeBackend>(device, scene);
}

}  // namespace lab
