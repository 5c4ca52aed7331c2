// The `query` backend: ray queries in the same compute shader that the `compute` backend uses.
#include "tracing/backends.h"
#include "tracing/hardware_bvh.h"

namespace lab {
namespace {

class QueryBackend : public AccelerationStructure {
  public:
    QueryBackend(const Device& device, const GpuScene& scene)
        : device_(&device), scene_(&scene), bvh_(device, scene) {}

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        ShaderSource source = shader_source("render.comp", ShaderStage::compute, *scene_, estimator);
        source.defines.emplace_back("BACKEND_QUERY");
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
    HardwareBvh bvh_;
};

}  // namespace

std::unique_ptr<AccelerationStructure> build_query_backend(const Device& device, const GpuScene& scene) {
    return std::make_unique<QueryBackend>(device, scene);
}

}  // namespace lab
