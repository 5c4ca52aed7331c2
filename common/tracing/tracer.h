// Runs an estimator on a scene. The backends differ in their acceleration structure and in how rays are
// traced.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "gpu/shader_compiler.h"
#include "tracing/gpu_scene.h"

namespace lab {

// A shader with the function path_trace(), and the defines that configure it.
struct Estimator {
    std::filesystem::path file;
    std::vector<std::string> defines = {};
    // Where `file` is an estimator that looks over another one's shoulder: that one's file, included as
    // "observed.glsl", and what is done to the text of both.
    std::filesystem::path observed = {};
    std::function<std::string(const std::string&)> edit = {};
};

// What #include stands for in shaders that run an estimator: "path_trace.glsl" is its file. A file of the same name
// in a chapter's folder replaces the default "random_words.glsl" and "sample_loop.glsl" of shaders/.
std::map<std::string, std::filesystem::path> named_includes(const Estimator& estimator);

// The files that an estimator is compiled from, with whatever backend: the shared shaders and its own.
std::set<std::filesystem::path> shader_files(const Estimator& estimator);

// A hash of what an estimator is compiled from: its defines and its own shaders, and those shared ones that
// are the same with every backend and on every device. Renders of estimators with equal hashes can be joined.
uint64_t estimator_hash(const Estimator& estimator);

// An estimator that is compiled for a scene and a backend.
class Tracer {
  public:
    virtual ~Tracer() = default;
    // Brings `block_count` blocks of pixels up to the asked number of samples. With the estimator's define
    // SHARED_PIXELS their samples are left to be added to the film by shaders/add_samples.comp. The binding
    // of the film begins `film_offset` bytes after its start.
    virtual void record(const vk::raii::CommandBuffer& commands, const DispatchParameters& dispatch,
                        uint32_t block_count, uint32_t film_offset) const = 0;
};

// A scene's acceleration structure, built once and used by all its tracers.
class AccelerationStructure {
  public:
    virtual ~AccelerationStructure() = default;
    // What make_tracer() compiles for an estimator, the main program first.
    virtual std::vector<ShaderSource> shaders(const Estimator& estimator) const = 0;
    // `bindings`: render parameters, film, ray counters, and the samples of pixels that are shared. Throws
    // UserError if the estimator does not compile.
    virtual std::unique_ptr<Tracer> make_tracer(const Estimator& estimator,
                                                std::span<const Binding> bindings) const = 0;
    virtual size_t bytes() const = 0;          // of device memory
    virtual double build_seconds() const = 0;  // by the CPU or the device, whichever built it
};

// Device and scene must outlive the result. Throws DeviceError if the device does not support the backend.
std::unique_ptr<AccelerationStructure> build_acceleration_structure(Backend backend, const Device& device,
                                                                    const GpuScene& scene);

}  // namespace lab
