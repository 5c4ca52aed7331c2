// Runs an estimator on a scene with one of the backends.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "gpu/shader_compiler.h"
#include "tracing/gpu_scene.h"

namespace lab {

// A shader with path_trace(), and its defines.
struct Estimator {
    std::filesystem::path file;
    std::vector<std::string> defines = {};
    // If `file` observes another estimator: that one's file, included as "observed.glsl", and an edit to both texts.
    std::filesystem::path observed = {};
    Replacements replacements = {};
    std::function<std::string(const std::string&)> edit = {};
    // Of an image with few pixels, whose threads share pixels.
    uint32_t max_threads_per_pixel = UINT32_MAX;
};

// Files for #include in shaders that run an estimator: "path_trace.glsl" is its own. Those that shaders/replaceable.json lists
// are looked up in its chapter's folder, then in that of the chapter which this one continues, and so on, and at last in
// shaders/.
std::map<std::string, std::filesystem::path> named_includes(const Estimator& estimator);

// The places of the shaders that --shader can replace: those of chapters/ that a chapter's estimator includes, and what its
// folder may bring.
std::set<std::filesystem::path> replaceable_places(const Estimator& estimator);

// All files that an estimator is compiled from, with any backend.
std::set<std::filesystem::path> shader_files(const Estimator& estimator);

// Hash of an estimator's defines and shaders, except for shaders that depend on backend or device. Renders with equal hashes can
// be merged.
uint64_t estimator_hash(const Estimator& estimator);

// An estimator compiled for a scene and a backend.
class Tracer {
  public:
    virtual ~Tracer() = default;
    // Renders `block_count` blocks of pixels up to the sample count of each step, one step after the other. `film_offset` in
    // bytes is that of the film's binding. Returns the seconds on the device, or nothing if an interrupt ended blocks too early.
    virtual std::optional<double> trace(std::span<const DispatchParameters> steps, uint32_t block_count,
                                        uint32_t film_offset) const = 0;
    // Whether several samples of a pixel take less time together, even if a dispatch has many pixels.
    virtual bool wants_samples_together() const { return false; }
    virtual std::string note() const { return {}; }  // what users of this backend should know, as a line of the program's
};

// A scene's acceleration structure, shared by its tracers.
class SceneBackend {
  public:
    virtual ~SceneBackend() = default;
    // The shaders that make_tracer() compiles, main program first.
    virtual std::vector<ShaderSource> shaders(const Estimator& estimator) const = 0;
    // `bindings`: render parameters, film, ray counters, and samples of shared pixels, if threads shall share pixels. Throws
    // UserError if the estimator does not compile.
    virtual std::unique_ptr<Tracer> make_tracer(const Estimator& estimator, std::span<const Binding> bindings) const = 0;
    virtual bool can_share_pixels() const { return true; }
    virtual size_t bytes() const = 0;          // of device memory
    virtual double build_seconds() const = 0;  // on the CPU or the device
};

}  // namespace lab
