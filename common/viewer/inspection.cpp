#include "viewer/inspection.h"

#include <cstring>

#include "files/hash.h"
#include "rendering/settings.h"

namespace lab {

// Glass has none: it reflects and refracts into single directions.
static bool has_brdf(const PathVertex& vertex, const Scene& scene) {
    return vertex.is_hit && scene.materials[scene.triangle_materials[vertex.triangle]].refractive_index == 0;
}

// Whether the tools for the session's estimator are there; if not, starts making them.
bool Inspection::have_tools(const Session& session) {
    if (work_.is_under_way()) {
        if (!work_.is_done()) return false;
        try {
            tools_ = work_.take();
            shown_.reset();
            message_.clear();
        } catch (const std::exception& error) {
            message_ = window_message(error);
            failed_hash_ = work_hash_;
        }
    }
    const WindowBuild& build = session.build();
    Options options = build.job.options;
    options.image.view = nullptr;
    const Estimator estimator = make_estimator(session.chapter(), options);
    uint64_t hash = hash_text(estimator.file.string(), build.shader_hash);
    for (const auto& define : estimator.defines) hash = hash_text(define + "\n", hash);
    const auto wanted = std::make_shared<Tools>(Tools{.scene = build.job.scene,
                                                      .gpu_scene = build.gpu_scene,
                                                      .acceleration_structure = build.acceleration_structure,
                                                      .estimator = estimator,
                                                      .hash = hash,
                                                      .image_size = build.job.parameters.image_size});
    if (tools_ && tools_->acceleration_structure == wanted->acceleration_structure && tools_->hash == hash &&
        tools_->image_size == wanted->image_size)
        return true;
    if (hash == failed_hash_) return false;
    work_hash_ = hash;
    work_.start([&device = device_, wanted] {
        const AccelerationStructure& structure = *wanted->acceleration_structure;
        wanted->recorder =
            std::make_unique<PathRecorder>(device, structure, wanted->estimator, wanted->image_size);
        wanted->hemisphere = std::make_unique<HemisphereView>(device, structure, wanted->estimator);
        return wanted;
    });
    return false;
}

void Inspection::update(const Session& session, double seconds) {
    if (!selection_ || session.reduction() > 1 || !have_tools(session)) {
        path_.reset();
        shown_.reset();
        has_hemisphere_ = false;
        return;
    }
    const RenderParameters& parameters = session.build().job.parameters;
    if (std::memcmp(&parameters, &parameters_, sizeof parameters) != 0) shown_.reset();
    parameters_ = parameters;
    selection_->pixel = glm::min(selection_->pixel, parameters.image_size - 1u);
    if (shown_ != selection_) {
        if (!shown_ || shown_->pixel != selection_->pixel || shown_->sample != selection_->sample)
            path_ = tools_->recorder->record(parameters, selection_->pixel,
                                             parameters.first_sample + selection_->sample);
        has_hemisphere_ = false;
        if (const auto& vertices = path_->vertices; !vertices.empty()) {  // else it traced no ray
            selection_->vertex = std::min(selection_->vertex, vertices.size() - 1);
            const PathVertex& vertex = vertices[selection_->vertex];
            has_hemisphere_ = has_brdf(vertex, *tools_->scene);
            if (has_hemisphere_) tools_->hemisphere->look_at(vertex, parameters);
        }
        shown_ = selection_;
    }
    if (!has_hemisphere_) return;
    constexpr uint32_t enough_samples = 256;
    tools_->hemisphere->set_dispatch_seconds(seconds);
    tools_->hemisphere->advance(enough_samples);
}

}  // namespace lab
