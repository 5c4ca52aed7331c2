#include "viewer/comparison_panel.h"

#include <imgui.h>

#include "rendering/numbers_text.h"
#include "viewer/inside_drawing.h"

namespace lab {
namespace {

void draw_choice(Comparison& comparison, const Session& first) {
    const std::string chosen = comparison.is_active() ? comparison.second().chapter().name : "none";
    if (ImGui::BeginCombo("beside", chosen.c_str())) {
        if (ImGui::Selectable("none")) comparison.stop();
        const std::string same = first.chapter().name + ", with the settings of now";
        if (ImGui::Selectable(same.c_str())) comparison.start(first, first.chapter().name);
        for (const std::string& chapter : comparison.chapters())
            if (chapter != first.chapter().name && ImGui::Selectable(chapter.c_str()))
                comparison.start(first, chapter);
        ImGui::EndCombo();
    }
    if (!comparison.is_active()) return;
    Equal& equal = comparison.equal;
    if (ImGui::RadioButton("equal time", equal == Equal::time)) equal = Equal::time;
    ImGui::SameLine();
    if (ImGui::RadioButton("equal samples", equal == Equal::samples)) equal = Equal::samples;
    ImGui::SliderFloat("split", &comparison.split, 0, 1, "%.2f");
}

void draw_numbers(const Comparison& comparison, const Session& first) {
    const Session& second = comparison.second();
    const auto row = [](const char* side, const Session& session) {
        const auto error = session.relative_error();
        ImGui::Text("%s %.6g samples, %s, error %s", side, session.samples(),
                    duration_text(session.seconds()).c_str(),
                    error ? (short_number(100 * *error) + " %").c_str() : "not known yet");
    };
    row("left: ", first);
    row("right:", second);
    if (const auto difference = comparison.difference(first))
        ImGui::Text("left - right: %+.2f %% ± %.2f %%", 100 * difference->value,
                    100 * 1.96 * difference->standard_error);
    if (const auto speedup = comparison.speedup(first))
        ImGui::TextWrapped("to equal error, right takes %.3g times as long as left", *speedup);
    const uint32_t length = first.build().job.parameters.max_path_length,
                   other = second.build().job.parameters.max_path_length;
    if (length != other)
        ImGui::TextWrapped("paths end after %u bounces left, %u right: the images differ", length, other);
    if (!second.message().empty()) ImGui::TextWrapped("%s", second.message().c_str());
}

}  // namespace

void draw_split(const Comparison& comparison, const Rectangle& picture) {
    if (!comparison.is_active()) return;
    const Placement placement(picture);
    ImGui::GetBackgroundDrawList()->AddLine(placement.at({comparison.split, 0}),
                                            placement.at({comparison.split, 1}),
                                            IM_COL32(255, 255, 255, 200));
}

void draw_controls(Comparison& comparison, const Session& first) {
    if (!ImGui::CollapsingHeader("compare")) return;
    draw_choice(comparison, first);
    if (comparison.is_building()) ImGui::TextUnformatted("building ...");
    if (!comparison.message().empty()) ImGui::TextWrapped("%s", comparison.message().c_str());
    if (comparison.is_active()) draw_numbers(comparison, first);
}

}  // namespace lab
