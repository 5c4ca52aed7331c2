#include "viewer/window_build.h"

#include "error.h"
#include "files/file.h"
#include "files/hash.h"

namespace lab {

uint64_t hash_of(const std::set<std::filesystem::path>& files) {
    uint64_t hash = 0;
    try {
        for (const auto& file : files) hash = hash_text(read_file(file, max_shader_bytes), hash + 1);
    } catch (const UserError&) {
        return 0;
    }
    return hash;
}

std::unique_ptr<WindowBuild> make_window_build(const Device& device, const Chapter& chapter, RenderJob job,
                                               BuildStage first, const WindowBuild* before) {
    auto build = std::make_unique<WindowBuild>();
    // Before they are compiled: what is changed meanwhile has another hash.
    build->shader_files = shader_files(job.estimator);
    build->shader_hash = hash_of(build->shader_files);
    static_cast<Build&>(*build) = make_build(device, chapter, std::move(job), first, before);
    const uvec2 size = build->job.parameters.image_size;
    std::shared_ptr<StorageImage> picture = before ? before->display->shared_picture() : nullptr;
    if (!picture || picture->width() != size.x || picture->height() != size.y)
        picture = std::make_shared<StorageImage>(device, size.x, size.y);
    build->display = std::make_unique<DisplayPass>(device, build->renderer->film(), std::move(picture));
    return build;
}

}  // namespace lab
