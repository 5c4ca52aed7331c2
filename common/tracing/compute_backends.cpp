// The backends that are compute shaders: `compute` traverses our hierarchy, `query` the driver's.
#include "tracing/backends.h"
#include "tracing/gpu_bvh.h"
#include "tracing/hardware_bvh.h"

namespace lab {
namespace {

class ComputeTracer : public Tracer {
  public:
    ComputeTracer(const Device& device, const std::vector<ShaderSource>& shaders,
                  std::span<const Binding> bindings)
        : kernel_(device, shaders.front(), bindings, sizeof(DispatchParameters)) {}

    void record(const vk::raii::CommandBuffer& commands, const DispatchParameters& dispatch,
                uint32_t block_count, uint32_t film_offset) const override {
        kernel_.record(commands, &dispatch, block_count * dispatch.threads_per_pixel, film_offset);
    }

  private:
    ComputeKernel kernel_;
};

class ComputeBackend : public SceneTree<GpuBvh, ComputeTracer> {
  public:
    using SceneTree::SceneTree;

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        ShaderSource source = shader_source("engine/render.comp", scene_, estimator);
        for (const auto& define : tree_.defines()) source.defines.push_back(define);
        return {source};
    }
};

class QueryBackend : public SceneTree<HardwareBvh, ComputeTracer> {
  public:
    using SceneTree::SceneTree;

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        ShaderSource source = shader_source("engine/render.comp", scene_, estimator);
        source.defines.emplace_back("BACKEND_QUERY");
        return {source};
    }
};

}  // namespace

std::unique_ptr<AccelerationStructure> build_compute_backend(const Device& device, const GpuScene& scene) {
    GpuBvh::require_room(device, scene.scene());
    return std::make_unique<ComputeBackend>(device, scene,
                                            GpuBvh(device, build_bvh(world_triangles(scene.scene()))));
}

std::unique_ptr<AccelerationStructure> build_query_backend(const Device& device, const GpuScene& scene) {
    return std::make_unique<QueryBackend>(device, scene, HardwareBvh(device, scene));
}

}  // namespace lab
