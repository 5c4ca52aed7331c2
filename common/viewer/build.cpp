#include "viewer/build.h"

#include "error.h"
#include "files/file.h"
#include "files/hash.h"
#include "rendering/backend_choice.h"
#include "rendering/settings.h"

namespace lab {

BuildStage first_difference(const Options& before, const Options& options) {
    if (before.scene != options.scene || before.specular != options.specular) return BuildStage::scene;
    if (before.light_sampling != options.light_sampling) return BuildStage::gpu_scene;
    if (before.view != options.view || before.split_every_hit != options.split_every_hit ||
        before.width != options.width || before.height != options.height)
        return BuildStage::renderer;
    return BuildStage::nothing;
}

Options keep_built(const Options& built, Options options) {
    options.scene = built.scene;
    options.specular = built.specular;
    options.light_sampling = built.light_sampling;
    options.view = built.view;
    options.split_every_hit = built.split_every_hit;
    options.width = built.width;
    options.height = built.height;
    return options;
}

uint64_t hash_of(const std::set<std::filesystem::path>& files) {
    uint64_t hash = 0;
    try {
        for (const auto& file : files) hash = hash_text(read_file(file, 1 << 24), hash + 1);
    } catch (const UserError&) {
        return 0;
    }
    return hash;
}

std::unique_ptr<Build> make_build(const Device& device, const Chapter& chapter, const Options& options,
                                  BuildStage first, const Build* before, std::shared_ptr<const Scene> scene) {
    auto build = std::make_unique<Build>();
    build->options = options;
    const Estimator estimator = make_estimator(chapter, options);
    build->shader_files = shader_files(estimator);
    build->shader_hash = hash_of(build->shader_files);

    if (scene)
        build->scene = std::move(scene);
    else if (first == BuildStage::scene)
        build->scene = std::make_shared<Scene>(load_scene(options.scene, options.specular));
    else
        build->scene = before->scene;
    check_scene(chapter, *build->scene);
    build->job = make_job(chapter, *build->scene, estimator, build->options);
    require_memory(device, Renderer::memory_needs(build->job.parameters.image_size));

    if (first <= BuildStage::gpu_scene) {
        const auto light_sampling =
            chapter.light_sampling && options.light_sampling ? LightSampling::on : LightSampling::off;
        build->gpu_scene = std::make_shared<GpuScene>(device, *build->scene, light_sampling);
        build->backend = choose_backend(options, device, *build->gpu_scene, estimator, build->job.parameters);
        build->acceleration_structure =
            build_acceleration_structure(build->backend, device, *build->gpu_scene);
    } else {
        build->gpu_scene = before->gpu_scene;
        build->backend = before->backend;
        build->acceleration_structure = before->acceleration_structure;
    }
    build->job.acceleration = {build->acceleration_structure->bytes(),
                               build->acceleration_structure->build_seconds()};
    record_device(build->job, device.description().name, to_string(build->backend));

    const uvec2 size = build->job.parameters.image_size;
    build->renderer =
        std::make_unique<Renderer>(device, *build->acceleration_structure, estimator, build->job.parameters);
    std::shared_ptr<StorageImage> picture = before ? before->display->shared_picture() : nullptr;
    if (!picture || picture->width() != size.x || picture->height() != size.y)
        picture = std::make_shared<StorageImage>(device, size.x, size.y);
    build->display = std::make_unique<DisplayPass>(device, build->renderer->film(), std::move(picture));
    return build;
}

}  // namespace lab
