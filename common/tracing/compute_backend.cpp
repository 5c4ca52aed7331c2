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

class ComputeBackend : public SceneTree<GpuBvh, make_compute_tracer> {
  public:
    using SceneTree::SceneTree;

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        ShaderSource source = shader_source("render.comp", ShaderStage::compute, scene(), estimator);
        for (const auto& define : tree().defines()) source.defines.push_back(define);
        return {source};
    }
};

}  // namespace

std::unique_ptr<AccelerationStructure> build_compute_backend(const Device& device, const GpuScene& scene) {
    return std::make_unique<ComputeBackend>(device, scene, GpuBvh(device, build(device, scene.scene())));
}

}  // namespace lab
