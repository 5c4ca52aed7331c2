// From options to a render: the same headless, in the window, and for a comparison beside it.
#pragma once
#include "rendering/denoiser.h"
#include "rendering/render_job.h"

namespace lab {

// Everything a device renders a job with. Unchanged parts are shared with the previous build.
struct Build {
    RenderJob job;
    std::shared_ptr<const GpuScene> gpu_scene;
    Backend backend = nullptr;
    std::shared_ptr<const SceneBackend> scene_backend;
    std::unique_ptr<Renderer> renderer;
    std::unique_ptr<Denoiser> denoiser;  // null without --filter
};

// What changed options ask for: to load and build from this stage on, only to begin with new samples, or nothing.
enum class BuildStage { scene, gpu_scene, renderer, samples, nothing };

// The first stage that must be repeated to go from the options `before` to these.
BuildStage first_difference(const Options& before, const Options& options);

// `options`, but with everything that comes before new samples taken from `built`.
Options keep_built(const Options& built, Options options);

// Builds from stage `first` on and takes earlier stages from `before`, which is null if `first` is the scene. A resumed render
// continues where it stopped. Throws UserError for a shader that does not compile, DeviceError for a backend that the device
// lacks, and DeviceFailure for what does not fit into its memory.
Build make_build(const Device& device, const Chapter& chapter, RenderJob job, BuildStage first = BuildStage::scene,
                 const Build* before = nullptr);

}  // namespace lab
