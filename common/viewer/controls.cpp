#include "viewer/controls.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "error.h"
#include "files/file.h"
#include "files/project_folder.h"
#include "rendering/backend_choice.h"
#include "rendering/numbers_text.h"
#include "rendering/render_job.h"
#include "rendering/settings.h"
#include "scene/features.h"
#include "viewer/inspection_drawing.h"
#include "viewer/text.h"

namespace lab {
namespace {

constexpr int longest_shown_path = 16;  // of the sliders, like the rows of pictures on the slides

float panel_width() { return 24 * ImGui::GetFontSize(); }

// A slider with a checkbox; unchecked leaves the number at `automatic`.
void optional_slider(const char* label, std::optional<uint32_t>& value, uint32_t automatic, int high) {
    ImGui::PushID(label);
    bool is_given = value.has_value();
    if (ImGui::Checkbox("##given", &is_given))
        value = is_given ? std::optional(std::min(automatic, static_cast<uint32_t>(high))) : std::nullopt;
    ImGui::SameLine();
    if (is_given) {
        int number = static_cast<int>(*value);
        if (ImGui::SliderInt(label, &number, 0, high, "%d", ImGuiSliderFlags_AlwaysClamp)) value = static_cast<uint32_t>(number);
    } else {
        ImGui::TextUnformatted(label);
    }
    ImGui::PopID();
}

// An input field for a whole number, which takes effect on Enter.
bool number_field(const char* label, uint32_t& number) {
    return ImGui::InputScalar(label, ImGuiDataType_U32, &number, nullptr, nullptr, "%u", ImGuiInputTextFlags_EnterReturnsTrue);
}

void draw_chapter_option(const ChapterOption& option, const RenderParameters& parameters, std::optional<double>& value) {
    const char* label = option.name.c_str() + 2;  // without the dashes
    const double low = option.low, high = option.high;
    if (const auto* member = std::get_if<uint32_t RenderParameters::*>(&option.parameter)) {
        int number = static_cast<int>(parameters.*(*member));
        if (ImGui::DragInt(label, &number, 0.05f, static_cast<int>(low), static_cast<int>(high), "%d",
                           ImGuiSliderFlags_AlwaysClamp))
            value = number;
    } else {
        float number = parameters.*std::get<float RenderParameters::*>(option.parameter);
        if (ImGui::SliderFloat(label, &number, static_cast<float>(low), static_cast<float>(high), "%.3f",
                               ImGuiSliderFlags_AlwaysClamp))
            value = std::clamp<double>(number, low, high);
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", option.help.c_str());
}

void draw_progress(const Session& session, double frames_per_second) {
    const FilmHeader& header = session.build().job.header;
    const double rendered = session.seconds(), seconds = std::max(rendered, 1e-9), samples = session.samples();
    ImGui::TextWrapped("%s", session.chapter().title.c_str());
    ImGui::TextWrapped("%s, backend %s", header.device.c_str(), header.backend.c_str());
    ImGui::Separator();
    const std::string target =
        session.target_samples() < UINT32_MAX - header.first_sample ? " of " + std::to_string(session.target_samples()) : "";
    text_in_words(samples_text(samples) + target + " samples per pixel in " + duration_text(rendered));
    text_in_words("per second: " + short_number(samples / seconds) + " samples, " +
                  short_number(static_cast<double>(session.rays()) / seconds) + " rays, " +
                  std::to_string(std::lround(frames_per_second)) + " frames");
    constexpr double wanted = 0.01;
    // One line whatever it says, so that the controls below keep their places.
    if (session.is_building())
        ImGui::TextUnformatted("building ...");
    else if (const auto error = session.relative_error(); error && *error > wanted && !session.is_filtered())
        ImGui::TextWrapped("noise %.3g %%, 1 %% in %s", 100 * *error,
                           duration_text(seconds * (std::pow(*error / wanted, 2) - 1)).c_str());
    else if (error)
        ImGui::Text("%s %.2g %%", session.is_filtered() ? "error" : "noise", 100 * *error);
    else
        ImGui::TextUnformatted(session.reduction() > 1 && !session.is_stuck() ? "reduced while the camera moves"
                                                                              : "error not known yet");
    ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1.0f, 0.45f, 0.4f, 1.0f));
    if (!session.message().empty()) text_in_words(session.message());
    ImGui::PopStyleColor();
}

void draw_strategy(const Chapter& chapter, EstimatorOptions& estimator) {
    if (chapter.strategies.empty()) return;
    const Strategy current = estimator.strategy.value_or(chapter.strategies.front());
    if (!ImGui::BeginCombo("light is found by", to_string(current).c_str())) return;
    for (const Strategy strategy : chapter.strategies)
        if (ImGui::Selectable(to_string(strategy).c_str(), strategy == current)) estimator.strategy = strategy;
    ImGui::EndCombo();
}

void draw_choice(const ChapterChoice& choice, size_t& chosen) {
    if (!ImGui::BeginCombo(choice.name.c_str() + 2, choice.values[chosen].first.c_str())) return;
    for (size_t i = 0; i < choice.values.size(); ++i)
        if (ImGui::Selectable(choice.values[i].first.c_str(), i == chosen)) chosen = i;
    ImGui::EndCombo();
}

void draw_picture(const Session& session, Options& options) {
    ImGui::Separator();
    const uvec2 size = session.build().job.parameters.image_size;
    if (ImGui::BeginCombo("view", options.image.view ? options.image.view->name.c_str() : "radiance")) {
        if (ImGui::Selectable("radiance", !options.image.view)) options.image.view = nullptr;
        for (const View& view : views()) {
            if (can_show(view, session.build().backend) && ImGui::Selectable(view.name.c_str(), options.image.view == &view))
                options.image.view = &view;
        }
        ImGui::EndCombo();
    }
    ImGui::SliderFloat("exposure", &options.appearance.exposure, -10, 10, "%.1f EV");
    uint32_t width = size.x, height = size.y;
    if (number_field("width (pixels)", width)) options.image.width = std::clamp(width, 1u, max_image_extent);
    if (number_field("height (pixels)", height)) options.image.height = std::clamp(height, 1u, max_image_extent);
}

}  // namespace

int Controls::width() const { return static_cast<int>(std::ceil(panel_width() * ImGui::GetIO().DisplayFramebufferScale.x)); }

void Controls::draw(Session& session, CameraControl& camera_control, const Rectangle& where, double frames_per_second,
                    const std::function<void()>& further) {
    const Placement placement(where);
    ImGui::SetNextWindowPos(placement.at({0, 0}));
    ImGui::SetNextWindowSize({placement.size.x, placement.size.y});
    ImGui::Begin("Controls", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PushItemWidth(0.45f * panel_width());
    draw_progress(session, frames_per_second);
    draw_actions(session);
    further();
    Options options = session.options();
    draw_scene(session, options);
    draw_paths(session.chapter(), session.build().job.parameters, options);
    draw_picture(session, options);
    session.change(options);
    draw_camera(session, camera_control);
    ImGui::PopItemWidth();
    ImGui::End();
}

void Controls::draw_actions(Session& session) {
    if (ImGui::Button(session.is_paused ? "Go on" : "Pause")) session.is_paused = !session.is_paused;
    ImGui::SameLine();
    if (ImGui::Button("Restart")) session.restart();
    ImGui::SameLine();
    if (ImGui::Button("Save PNG")) save(session, ".png");
    ImGui::SameLine();
    if (ImGui::Button("Save EXR")) save(session, ".exr");
    if (!notice_.empty()) ImGui::TextWrapped("%s", notice_.c_str());
}

void Controls::save(Session& session, const char* ending) {
    const std::string scene = session.build().job.scene->file.stem().string();
    const std::string samples = std::to_string(static_cast<uint64_t>(session.samples()));
    const auto file =
        std::filesystem::path("output") / (session.chapter().name + "_" + scene + "_" + samples + "_samples" + ending);
    try {
        check_writable(file);
        session.save({file});
        notice_ = "saved " + file.string();
    } catch (const UserError& error) {
        notice_ = error.what();
    }
}

void Controls::draw_scene(Session& session, Options& options) {
    ImGui::Separator();
    if (ImGui::BeginCombo("scene", options.scene.file.stem().string().c_str())) {
        for (const auto& file : scenes_)
            if (ImGui::Selectable(file.stem().string().c_str(), file.stem() == options.scene.file.stem())) {
                session.open_scene(file);
                options = session.options();
            }
        ImGui::EndCombo();
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Or drop a .json or .obj file on the window");
    vec3 background = session.background();
    if (ImGui::ColorEdit3("background radiance", &background.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR))
        options.light.background = glm::max(background, vec3(0));
    // The file's own lobes cannot be switched off.
    const Scene& scene = *session.build().job.scene;
    const bool are_of_file = !scene.has_added_lobes && features_of(scene).specular();
    bool has_lobes = are_of_file || options.scene.specular;
    ImGui::BeginDisabled(are_of_file);
    if (ImGui::Checkbox(are_of_file ? "specular lobes (Ks), of the scene" : "specular lobes (Ks)", &has_lobes))
        options.scene.specular = has_lobes;
    lobes_box_ = {ImGui::GetItemRectMin().x + 8, ImGui::GetItemRectMin().y + 8};
    ImGui::EndDisabled();
}

void Controls::draw_paths(const Chapter& chapter, const RenderParameters& parameters, Options& options) {
    ImGui::Separator();
    optional_slider("max path length", options.light.max_path_length, parameters.max_path_length, longest_shown_path);
    optional_slider("only path length", options.light.only_path_length, 1, longest_shown_path);
    if (options.light.max_path_length && options.light.only_path_length)
        options.light.max_path_length = std::max(*options.light.max_path_length, *options.light.only_path_length);
    draw_strategy(chapter, options.estimator);
    for (const ChapterChoice& choice : chapter.choices) draw_choice(choice, options.estimator.choices[choice.name]);
    options.samples.chapter_values.resize(chapter.options.size());
    for (size_t i = 0; i < chapter.options.size(); ++i)
        draw_chapter_option(chapter.options[i], parameters, options.samples.chapter_values[i]);
    number_field("seed", options.samples.seed);
    seed_field_ = {ImGui::GetItemRectMin().x + 20, ImGui::GetItemRectMin().y + 5};
    uint32_t samples = options.appearance.sample_count.value_or(0);
    if (number_field("samples (0: no end)", samples))
        options.appearance.sample_count = samples > 0 ? std::optional(samples) : std::nullopt;
}

void Controls::draw_camera(Session& session, CameraControl& camera_control) {
    ImGui::Separator();
    Navigation& navigation = camera_control.navigation;
    if (ImGui::RadioButton("first person", navigation == Navigation::first_person)) navigation = Navigation::first_person;
    ImGui::SameLine();
    if (ImGui::RadioButton("orbit", navigation == Navigation::orbit)) navigation = Navigation::orbit;
    CameraPose pose = session.camera();
    if (ImGui::SliderFloat("field of view", &pose.vertical_fov, 1, 150, "%.0f degrees", ImGuiSliderFlags_AlwaysClamp))
        session.set_camera(pose);
    if (session.chapter().handles.lens) {
        float distance = session.build().job.parameters.camera.focus_distance;
        if (ImGui::SliderFloat("aperture diameter", &pose.aperture_diameter, 0, 0.25f * distance, "%.3g",
                               ImGuiSliderFlags_AlwaysClamp))
            session.set_camera(pose);
        // By 1 % a pixel, in scenes of any size.
        if (ImGui::DragFloat("focus distance", &distance, 0.01f * distance, 1e-30f, 1e30f, "%.3g",
                             ImGuiSliderFlags_AlwaysClamp)) {
            pose.focus_distance = distance;
            session.set_camera(pose);
        }
        focus_field_ = {ImGui::GetItemRectMin().x + 20, ImGui::GetItemRectMin().y + 5};
    }
    const auto copy = [&](const char* button, const std::string& text) {
        if (!ImGui::Button(button)) return;
        ImGui::SetClipboardText(text.c_str());
        std::printf("%s\n", text.c_str());
        std::fflush(stdout);
        notice_ = "copied the camera";
    };
    copy("Copy flags", camera_flags(pose, '='));
    ImGui::SameLine();
    copy("Copy JSON", camera_json(pose));
    ImGui::SameLine();
    if (ImGui::Button("First camera (F)")) session.reset_camera();
    ImGui::TextWrapped(
        "W A S D Q E move, %s units of the scene per second (wheel); drag to look. Moving ends the verdict: "
        "F goes back. T: tiles, Tab hides this, space pauses, R restarts",
        short_number(camera_control.speed()).c_str());
}

}  // namespace lab
