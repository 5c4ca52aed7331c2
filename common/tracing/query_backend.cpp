// The `query` backend: ray queries in the same compute shader that the `compute` backend uses.
#include "tracing/backends.h"
#include "tracing/hardware_bvh.h"

namespace lab {
namespace {

class QueryBackend : public SceneTree<HardwareBvh, make_compute_tracer> {
  public:
    using SceneTree::SceneTree;

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        ShaderSource source = shader_source("render.comp", ShaderStage::compute, scene(), estimator);
        source.defines.emplace_back("BACKEND_QUERY");
        return {source};
    }
};

}  // namespace

std::unique_ptr<AccelerationStructure> build_query_backend(const Device& device, const GpuScene& scene) {
    return std::make_unique<QueryBackend>(device, scene, HardwareBvh(device, scene));
}

}  // namespace lab
