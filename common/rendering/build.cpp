#include "rendering/build.h"

#include <functional>

#include "rendering/backend_choice.h"
#include "rendering/settings.h"

namespace lab {
namespace {

// Records what the job runs on: "several" if it continues a run on something else.
void record_device(RenderJob& job, const std::string& device, const std::string& backend) {
    job.header.device = !job.resumed || job.resumed->header.device == device ? device : "several";
    job.header.backend = !job.resumed || job.resumed->header.backend == backend ? backend : "several";
}

}  // namespace

BuildStage first_difference(const Options& before, const Options& options) {
    const auto differs = [&](auto part) { return std::invoke(part, before) != std::invoke(part, options); };
    const auto samples_lights = [](const Options& o) { return o.estimator.strategy != Strategy::bounces; };
    if (differs(&Options::scene)) return BuildStage::scene;
    if (differs(samples_lights)) return BuildStage::gpu_scene;
    if (differs(&Options::estimator) || differs(&Options::image) || differs(asks_for_sky) || differs(asks_for_lens))
        return BuildStage::renderer;
    if (differs(&Options::camera) || differs(&Options::light) || differs(&Options::samples)) return BuildStage::samples;
    return BuildStage::nothing;
}

Options keep_built(const Options& built, Options options) {
    options.scene = built.scene;
    options.estimator = built.estimator;
    options.image = built.image;
    if (asks_for_sky(options) != asks_for_sky(built)) options.light.background = built.light.background;
    if (asks_for_lens(options) != asks_for_lens(built)) options.camera = built.camera;
    return options;
}

Build make_build(const Device& device, const Chapter& chapter, RenderJob job, BuildStage first, const Build* before) {
    Build build;
    build.job = std::move(job);
    const RenderJob& wanted = build.job;
    // Fail before loading the scene takes time and memory.
    std::vector<MemoryNeed> needs = Renderer::memory_needs(wanted.parameters.image_size, wanted.parameters.splat_unit);
    if (wanted.filter.passes > 0)
        for (MemoryNeed& need : Denoiser::memory_needs(wanted.parameters.image_size)) needs.push_back(std::move(need));
    require_memory(device, needs);
    if (first <= BuildStage::gpu_scene) {
        build.gpu_scene =
            std::make_shared<GpuScene>(device, *wanted.scene, strategy_of(chapter, wanted.options), chapter.handles);
        build.backend = choose_backend(wanted, device, *build.gpu_scene);
        build.scene_backend = build.backend->build(device, *build.gpu_scene);
    } else {
        build.gpu_scene = before->gpu_scene;
        build.backend = before->backend;
        build.scene_backend = before->scene_backend;
    }
    record_device(build.job, device.description().name, to_string(build.backend));
    build.renderer = std::make_unique<Renderer>(device, *build.scene_backend, wanted.estimator, wanted.parameters);
    if (wanted.filter.passes > 0)
        build.denoiser =
            std::make_unique<Denoiser>(device, *build.scene_backend, wanted.estimator, wanted.filter, wanted.parameters);
    if (wanted.resumed) build.renderer->resume(wanted.resumed->image);
    return build;
}

}  // namespace lab
