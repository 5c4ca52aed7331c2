// The way from options to a render, the same without a window, in one, and beside another render in it.
#pragma once
#include "rendering/render_job.h"

namespace lab {

// What a device renders a job with. Parts that do not change are shared with the build before.
struct Build {
    RenderJob job;
    std::shared_ptr<const GpuScene> gpu_scene;
    Backend backend = Backend::compute;
    std::shared_ptr<const AccelerationStructure> acceleration_structure;
    std::unique_ptr<Renderer> renderer;
};

// What has to be made anew, each with all that follows.
enum class BuildStage { scene, gpu_scene, renderer, nothing };

// The first thing in which a build for these options differs from one for `before`.
BuildStage first_difference(const Options& before, const Options& options);

// `options` with what takes a build as it is in `built`.
Options keep_built(const Options& built, Options options);

// Builds from `first` on and takes the rest from `before`, which is null for a build from the scene on. A render that is resumed
// goes on where it was. Throws UserError for a shader that does not compile, DeviceError for a backend that the device lacks, and
// DeviceFailure for what does not fit into its memory.
Build make_build(const Device& device, const Chapter& chapter, RenderJob job, BuildStage first = BuildStage::scene,
                 const Build* before = nullptr);

}  // namespace lab
