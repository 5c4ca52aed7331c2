// What a window renders with: everything that takes long to make, so that a thread of its own makes it.
#pragma once
#include <memory>
#include <set>

#include "rendering/render_job.h"
#include "viewer/display_pass.h"

namespace lab {

// Parts that do not change are shared with the build before.
struct Build {
    Options options;  // that it was made for
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const GpuScene> gpu_scene;
    Backend backend = Backend::compute;
    std::shared_ptr<const AccelerationStructure> acceleration_structure;
    std::set<std::filesystem::path> shader_files;
    uint64_t shader_hash = 0;  // of their contents
    RenderJob job;             // of `options`
    std::unique_ptr<Renderer> renderer;
    std::unique_ptr<DisplayPass> display;
};

// What has to be made anew, each with all that follows.
enum class BuildStage { scene, gpu_scene, renderer, nothing };

// The first thing in which a build for these options differs from one for `before`.
BuildStage first_difference(const Options& before, const Options& options);

// `options` with what takes a build as it is in `built`.
Options keep_built(const Options& built, Options options);

// Makes a build from `first` on and takes the rest from `before`, which is null for the first build: that
// gets the scene. Throws UserError for what the user can mend: a bad scene, a shader that does not compile.
std::unique_ptr<Build> make_build(const Device& device, const Chapter& chapter, const Options& options,
                                  BuildStage first, const Build* before,
                                  std::shared_ptr<const Scene> scene = nullptr);

// Hash of the contents of all files; 0 if one cannot be read now, as while an editor replaces it.
uint64_t hash_of(const std::set<std::filesystem::path>& files);

}  // namespace lab
