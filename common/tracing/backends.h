// What the backends share with each other and with the function that chooses among them.
#pragma once
#include "tracing/tracer.h"

namespace lab {

std::unique_ptr<AccelerationStructure> build_compute_backend(const Device& device, const GpuScene& scene);
std::unique_ptr<AccelerationStructure> build_query_backend(const Device& device, const GpuScene& scene);
std::unique_ptr<AccelerationStructure> build_pipeline_backend(const Device& device, const GpuScene& scene);

// A shader of shaders/ that renders the estimator on the scene.
ShaderSource shader_source(const std::string& name, ShaderStage stage, const GpuScene& scene,
                           const Estimator& estimator);

// The bindings of all the lists.
std::vector<Binding> join(std::initializer_list<std::span<const Binding>> lists);

// A compute shader that renders an estimator: workgroups of blocks of pixels.
std::unique_ptr<Tracer> make_compute_tracer(const Device& device, const ShaderSource& source,
                                            std::span<const Binding> bindings);

}  // namespace lab
