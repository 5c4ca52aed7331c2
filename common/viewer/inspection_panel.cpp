#include "viewer/inspection_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "files/file.h"
#include "rendering/settings.h"
#include "statistics/error_metrics.h"
#include "tracing/limited_loops.h"
#include "viewer/inspection_drawing.h"
#include "viewer/text.h"

namespace lab {
namespace {

const ImVec4 grey(0.65f, 0.65f, 0.65f, 1), green(0.45f, 0.9f, 0.45f, 1), red(1.0f, 0.45f, 0.4f, 1);

ImVec4 colour_of(VerdictState state) {
    return state == VerdictState::agrees ? green : state == VerdictState::biased ? red : grey;
}

void text_vector(const char* format, const char* name, const vec3& v) {
    char text[160];
    std::snprintf(text, sizeof text, format, name, v.x, v.y, v.z);
    text_in_words(text);
}
void text_colour(const char* name, const vec3& v) { text_vector("%s RGB %.3g %.3g %.3g", name, v); }
void text_point(const char* name, const vec3& v) { text_vector("%s (%.3g, %.3g, %.3g)", name, v); }

// What a camera ray sees behind the open boundaries of media: null if a medium or the sky comes first.
const PathVertex* first_seen(const RecordedPath& path, const Scene& scene) {
    for (const PathVertex& vertex : path.vertices)
        if (!vertex.is_hit || !scene.mesh_of(vertex.instance).is_open) return vertex.is_hit ? &vertex : nullptr;
    return nullptr;
}

// What a path did at one of its hits.
void list_vertex(const PathVertex& vertex, bool is_weighted, bool is_of_light_path) {
    if (vertex.survival_probability) ImGui::Text("survived with probability %.3g", *vertex.survival_probability);
    if (is_weighted) text_colour("throughput", vertex.throughput);
    if (vertex.is_collision) {
        text_point("collides in the medium, at", vertex.position);
    } else if (vertex.is_hit) {
        text_point("position", vertex.position);
        text_point("normal", vertex.normal);
    } else {
        text_point("leaves the scene towards", vertex.direction);
    }
    for (const LightSample& light : vertex.light_samples) {
        const char* sample = light.point ? "light sample at" : "light sample of the sky, towards";
        text_point(is_of_light_path ? "seen from the camera, at" : sample, light.point.value_or(light.direction));
        if (light.is_visible)
            text_colour("  visible: adds", light.radiance);
        else
            ImGui::TextUnformatted("  hidden: adds nothing");
        if (!light.branch.empty()) ImGui::Text("  by %zu nodes of the tree (green)", light.branch.size());
    }
    if (vertex.radiance != vec3(0) && !is_of_light_path) text_colour("radiance found", vertex.radiance);
    for (const float probability : vertex.lost_roulettes) ImGui::Text("Russian roulette: ended, survival %.3g", probability);
}

}  // namespace

int InspectionPanel::height() const {
    if (!inspection_.selection()) return 0;
    return static_cast<int>(17 * ImGui::GetFontSize() * ImGui::GetIO().DisplayFramebufferScale.y);
}

void InspectionPanel::draw(const Session& session, const Session* beside, float split, const Rectangle& picture,
                           const Rectangle& panel, double seconds) {
    select_clicked_pixel(session, split, picture);
    const Session& inspected = is_beside_ && beside ? *beside : session;
    inspection_.update(inspected, seconds);
    overlay_.draw(session, picture);
    if (hovered_) overlay_.explain(session, *hovered_);
    if (inspection_.path())
        draw_path(*inspection_.path(), inspection_.parameters().camera, inspection_.selection()->vertex, picture);

    const std::string whose = beside ? "A path of " + inspected.chapter().name : "A path";
    if (inspection_.selection() && panel.size.y > 0) draw_panel(whose, panel);
}

void InspectionPanel::draw_panel(const std::string& whose, const Rectangle& panel) {
    const Placement placement(panel);
    ImGui::SetNextWindowPos({placement.corner.x, placement.corner.y});
    ImGui::SetNextWindowSize({placement.size.x, placement.size.y});
    ImGui::SetNextWindowBgAlpha(1);  // controls may be behind it
    const auto& selection = *inspection_.selection();
    const std::string title = whose + ": sample " + std::to_string(selection.sample) + " of pixel (" +
                              std::to_string(selection.pixel.x) + ", " + std::to_string(selection.pixel.y) + ")###path";
    bool is_open = true;
    if (ImGui::Begin(title.c_str(), &is_open,
                     ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse)) {
        if (inspection_.is_building()) ImGui::TextColored(grey, "compiling the recorder ...");
        if (!inspection_.message().empty()) ImGui::TextWrapped("%s", inspection_.message().c_str());
        if (inspection_.path()) {
            draw_sample();
            // Side by side where there is room for whole lines, or else one below the other.
            const ImVec2 free = ImGui::GetContentRegionAvail();
            const bool is_narrow = free.x < 30 * ImGui::GetFontSize();
            ImGui::BeginChild("vertices", is_narrow ? ImVec2(0, 0.33f * free.y) : ImVec2(0.56f * free.x, 0), true);
            draw_vertices();
            ImGui::EndChild();
            if (!is_narrow) ImGui::SameLine();
            ImGui::BeginChild("hemisphere");
            draw_hemisphere();
            ImGui::EndChild();
        }
    }
    ImGui::End();
    if (!is_open) inspection_.deselect();
}

void InspectionPanel::draw_controls(Session& session) {
    ImGui::Separator();
    draw_verdict(session);
    if (const auto& settings = session.settings_for_verdict()) {
        const std::string label =
            "Verdict: max path length " + std::to_string(settings->max_path_length) + ", " + size_text(settings->image_size);
        if (ImGui::Button(label.c_str())) session.change_for_verdict();
    }
    const auto& path = inspection_.path();
    const PathVertex* seen = path && !is_beside_ ? first_seen(*path, *session.build().job.scene) : nullptr;
    if (session.chapter().handles.lens && seen && ImGui::Button("Focus on the point that was clicked"))
        session.focus_on(seen->position);
    if (ImGui::CollapsingHeader("look inside")) {
        int overlay = static_cast<int>(overlay_.shown);
        ImGui::Combo("tiles (T)", &overlay, overlay_names, static_cast<int>(std::size(overlay_names)));
        overlay_.shown = static_cast<Overlay>(overlay);
        draw_pixel(session);
    }
    if (!overlay_.legend().empty()) ImGui::TextWrapped("%s", overlay_.legend().c_str());
}

void InspectionPanel::select_clicked_pixel(const Session& session, float split, const Rectangle& picture) {
    const ImGuiIO& io = ImGui::GetIO();
    const glm::uvec2 size = session.build().job.parameters.image_size;
    const Placement placement(picture);
    const glm::vec2 position = (glm::vec2(io.MousePos.x, io.MousePos.y) - placement.corner) / placement.size;
    hovered_.reset();
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) was_dragged_ = io.WantCaptureMouse;
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Left)) was_dragged_ = true;
    const bool is_inside =
        glm::all(glm::greaterThanEqual(position, glm::vec2(0))) && glm::all(glm::lessThan(position, glm::vec2(1)));
    if (io.WantCaptureMouse || !is_inside) return;
    hovered_ = glm::min(glm::uvec2(position * glm::vec2(size)), size - 1u);
    // A drag moves the camera instead.
    if (ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !was_dragged_) {
        inspection_.select(*hovered_);
        is_beside_ = position.x >= split;
    }
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Right)) inspection_.deselect();
}

void InspectionPanel::draw_verdict(const Session& session) {
    const VerdictState state = session.verdict_state();
    std::string text = session.verdict_text();
    if (session.has_moved()) text += "\nF: back to the first camera";
    const std::string lines = broken_between_words(text, ImGui::GetContentRegionAvail().x);
    // Nothing below jumps as long as three lines are enough.
    const float height = std::max(3 * ImGui::GetTextLineHeightWithSpacing(),
                                  ImGui::CalcTextSize(lines.c_str()).y + ImGui::GetStyle().ItemSpacing.y);
    ImGui::BeginChild("verdict", {0, height}, false, ImGuiWindowFlags_NoScrollbar);
    ImGui::PushStyleColor(ImGuiCol_Text, colour_of(state));
    ImGui::TextUnformatted(lines.c_str());
    ImGui::PopStyleColor();
    ImGui::EndChild();
    if (state != VerdictState::none && ImGui::IsItemHovered())
        ImGui::SetTooltip("An unbiased render is ever called biased with a probability of %.3g",
                          LiveVerdict::default_false_alarms);
}

void InspectionPanel::draw_pixel(const Session& session) {
    const std::optional<Inspection::Selection>& selection = inspection_.selection();
    const FilmImage& film = session.last_snapshot();
    const std::optional<glm::uvec2> pixel = hovered_ ? hovered_ : selection ? std::optional(selection->pixel) : std::nullopt;
    if (pixel && pixel->x < film.width && pixel->y < film.height) {
        const NoiseEstimate value = estimate_noise(film, *pixel, {1, 1});
        const glm::uvec2 corner = *pixel - glm::min(*pixel, glm::uvec2(3));
        const NoiseEstimate around = estimate_noise(film, corner, {7, 7});
        ImGui::TextWrapped("pixel (%u, %u): mean of %.0f samples, %llu invalid", pixel->x, pixel->y, value.samples,
                           static_cast<unsigned long long>(value.invalid_samples));
        text_colour("radiance", vec3(value.mean[0], value.mean[1], value.mean[2]));
        ImGui::Text("standard error about %.2g", around.standard_error);
    } else {
        ImGui::TextColored(grey, "point at a pixel for its value");
    }
    if (!selection) ImGui::TextColored(grey, "click: follow a path; right click: leave it");
}

void InspectionPanel::draw_sample() {
    auto& selection = *inspection_.selection();
    const RecordedPath& path = *inspection_.path();
    // Buttons first, so that changing numbers do not move them.
    if (ImGui::SmallButton("<") && selection.sample > 0) --selection.sample;
    ImGui::SameLine();
    if (ImGui::SmallButton(">")) ++selection.sample;
    ImGui::SameLine();
    text_colour("this sample's radiance", path.radiance);
}

void InspectionPanel::draw_vertices() {
    auto& selection = *inspection_.selection();
    const RecordedPath& path = *inspection_.path();
    if (!path.is_complete) ImGui::TextColored(red, "too long to be shown as a whole");
    const bool is_weighted = path.has_throughput || path.vertices.size() == 1;
    if (!is_weighted) ImGui::TextColored(red, "the shader has no variable `throughput` to follow");
    for (size_t i = 0; i < path.vertices.size(); ++i) {
        const PathVertex& vertex = path.vertices[i];
        ImGui::PushID(static_cast<int>(i));
        char title[80];
        std::snprintf(title, sizeof title, vertex.parent < 0 ? "x%zu, seen by the camera" : "x%zu, after x%d", i + 1,
                      vertex.parent + 1);
        if (ImGui::Selectable(title, i == selection.vertex)) selection.vertex = i;
        list_vertex(vertex, is_weighted, false);
        ImGui::PopID();
    }
    for (size_t i = 0; i < path.light_path.size(); ++i) {
        ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(light_path_colour), "y%zu, bounce %zu of the light path", i + 1, i + 1);
        list_vertex(path.light_path[i], is_weighted, true);
    }
}

void InspectionPanel::draw_hemisphere() {
    if (!inspection_.has_hemisphere()) {
        text_in_words("no hemisphere: glass, a medium, or beyond the scene");
        return;
    }
    const HemisphereView& view = inspection_.hemisphere();
    if (view.samples() < 1) return;
    // Updates whenever the sample count has doubled, or the point has changed.
    if (pictures_samples_ < 0 || view.samples() < pictures_samples_ || view.samples() >= 2 * pictures_samples_) {
        pictures_ = view.pictures();
        pictures_samples_ = std::floor(view.samples());
    }
    const size_t vertex = inspection_.selection()->vertex + 1;
    const auto largest = [](const Image& image) {
        return std::max(*std::max_element(image.pixels.begin(), image.pixels.end()), 1e-9f);
    };
    double mean = 0;
    for (const float value : pictures_.incoming_radiance.pixels) mean += value;
    mean /= static_cast<double>(pictures_.incoming_radiance.pixels.size());
    text_in_words("what x" + std::to_string(vertex) + " sees: incoming radiance, BRDF, cosine");
    // In a row, or where there is little room the last two smaller, one below the other.
    const ImVec2 free = ImGui::GetContentRegionAvail();
    const float space = ImGui::GetStyle().ItemSpacing.x, gap = ImGui::GetStyle().ItemSpacing.y;
    const float tall = free.y - 3.5f * ImGui::GetTextLineHeightWithSpacing(), in_row = (free.x - 2 * space) / 3;
    const bool is_row = in_row >= 0.8f * tall;
    const float first = std::max(is_row ? std::min(in_row, tall) : std::min(0.66f * (free.x - space), tall), 1.0f);
    const float others = is_row ? first : std::max(0.5f * (first - gap), 1.0f);
    draw_disc(pictures_.incoming_radiance, mean > 0 ? static_cast<float>(0.25 / mean) : 1, first);
    ImGui::SameLine();
    ImGui::BeginGroup();
    draw_disc(pictures_.brdf, 1 / largest(pictures_.brdf), others);
    if (is_row) ImGui::SameLine();
    draw_disc(pictures_.cosine, 1, others);
    ImGui::EndGroup();
    text_colour("their product reflects radiance", pictures_.reflected_radiance());
    ImGui::Text("mean of %.0f samples", pictures_samples_);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip(
            "The hemisphere seen from above, in equal areas: the normal in the middle, the horizon at the "
            "rim");
}

// Glass has none: it reflects and refracts into single directions.
static bool has_brdf(const PathVertex& vertex, const Scene& scene) {
    return vertex.is_hit && scene.material_of(vertex.triangle).refractive_index == 0;
}

// The tree is the first of the light choices, so no define asks for it.
static bool descends_light_tree(const GpuScene& scene, const Estimator& estimator) {
    return std::ranges::count(scene.defines(), "FEATURE_LIGHT_TREE") > 0 &&
           std::ranges::none_of(estimator.defines, [](const std::string& text) { return text.starts_with("LIGHT_CHOICE "); });
}

// Whether the tools for the session's estimator are ready; if not, starts building them.
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
    const Estimator estimator = with_limited_loops(make_estimator(session.chapter(), options));
    uint64_t hash = hash_text(estimator.file.string(), build.shader_hash);
    for (const auto& define : estimator.defines) hash = hash_text(define + "\n", hash);
    const auto wanted = std::make_shared<Tools>(Tools{.scene = build.job.scene,
                                                      .gpu_scene = build.gpu_scene,
                                                      .scene_backend = build.scene_backend,
                                                      .estimator = estimator,
                                                      .hash = hash,
                                                      .parameters = build.job.parameters});
    if (tools_ && tools_->scene_backend == wanted->scene_backend && tools_->hash == hash &&
        tools_->parameters.image_size == wanted->parameters.image_size &&
        tools_->parameters.splat_unit == wanted->parameters.splat_unit)
        return true;
    if (hash == failed_hash_) return false;
    work_hash_ = hash;
    work_.start([&device = device_, wanted] {
        const SceneBackend& scene_backend = *wanted->scene_backend;
        wanted->recorder = std::make_unique<PathRecorder>(device, scene_backend, wanted->estimator, wanted->parameters);
        wanted->hemisphere = std::make_unique<HemisphereView>(device, scene_backend, wanted->estimator);
        if (descends_light_tree(*wanted->gpu_scene, wanted->estimator))
            wanted->light_branches = std::make_unique<LightBranches>(*wanted->scene);
        return wanted;
    });
    return false;
}

void Inspection::update(const Session& session, double seconds) try {
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
        message_.clear();
        if (!shown_ || shown_->pixel != selection_->pixel || shown_->sample != selection_->sample) {
            path_ = tools_->recorder->record(parameters, selection_->pixel, parameters.first_sample + selection_->sample);
            if (tools_->light_branches) tools_->light_branches->add_to(*path_);
        }
        has_hemisphere_ = false;
        if (const auto& vertices = path_->vertices; !vertices.empty()) {  // otherwise it traced no ray
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
} catch (const StuckLoop& loop) {
    message_ = window_message(loop);
    path_.reset();
    has_hemisphere_ = false;
    shown_ = selection_;  // not again
}

}  // namespace lab
