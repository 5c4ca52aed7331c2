// The backends that Vulkan traces rays with, and what they share.
#pragma once
#include "gpu/compute_kernel.h"
#include "tracing/backend.h"

namespace lab {

extern const BackendRow pipeline_row, query_row, compute_row;
inline constexpr Backend pipeline_backend = &pipeline_row;  // VK_KHR_ray_tracing_pipeline
inline constexpr Backend query_backend = &query_row;        // VK_KHR_ray_query in a compute shader
inline constexpr Backend compute_backend = &compute_row;    // our own bounding volume hierarchy in a compute shader

// A shader of shaders/, with the defines for this scene and estimator.
ShaderSource shader_source(const std::string& name, const GpuScene& scene, const Estimator& estimator);

// Submits what a tracer records.
class DeviceTracer : public Tracer {
  public:
    DeviceTracer(const Device& device, std::span<const Binding> bindings);
    std::optional<double> trace(std::span<const DispatchParameters> steps, uint32_t block_count,
                                uint32_t film_offset) const final;

  private:
    virtual void record(const vk::raii::CommandBuffer& commands, const DispatchParameters& dispatch, uint32_t block_count,
                        uint32_t film_offset) const = 0;

    const Device& device_;
    std::optional<ComputeKernel> adder_;  // of the samples of shared pixels to the film
    mutable bool has_ended_ = false;      // with samples
};

// A scene's tree and the tracers for it. Backends add their shaders.
template <typename Tree, typename TreeTracer>
class SceneTree : public SceneBackend {
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
