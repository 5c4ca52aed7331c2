// What the backends and build_acceleration_structure() share.
#pragma once
#include "tracing/tracer.h"

namespace lab {

std::unique_ptr<AccelerationStructure> build_compute_backend(const Device& device, const GpuScene& scene);
std::unique_ptr<AccelerationStructure> build_query_backend(const Device& device, const GpuScene& scene);
std::unique_ptr<AccelerationStructure> build_pipeline_backend(const Device& device, const GpuScene& scene);
std::unique_ptr<AccelerationStructure> build_native_backend(const GpuScene& scene);

// A shader of shaders/, with the defines for this scene and estimator.
ShaderSource shader_source(const std::string& name, const GpuScene& scene, const Estimator& estimator);

// A scene's tree and the tracers for it. Backends add their shaders.
template <typename Tree, typename TreeTracer>
class SceneTree : public AccelerationStructure {
  public:
    SceneTree(const Device& device, const GpuScene& scene, Tree tree) : device_(device), scene_(scene), tree_(std::move(tree)) {}

    std::unique_ptr<Tracer> make_tracer(const Estimator& estimator, std::span<const Binding> bindings) const final {
        std::vector<Binding> all(bindings.begin(), bindings.end());
        for (const auto& further : {scene_.bindings(), tree_.bindings()}) all.insert(all.end(), further.begin(), further.end());
        return std::make_unique<TreeTracer>(device_, shaders(estimator), all);
    }
    size_t bytes() const final { return tree_.bytes(); }
    double build_seconds() const final { return tree_.build_seconds(); }

  protected:
    const Device& device_;
    const GpuScene& scene_;
    const Tree tree_;
};

}  // namespace lab
