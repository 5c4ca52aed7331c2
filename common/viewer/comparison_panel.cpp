#include "viewer/comparison_panel.h"

#include <imgui.h>

#include "rendering/numbers_text.h"
#include "viewer/inside_drawing.h"

namespace lab {

void ComparisonPanel::draw_split(const Rectangle& picture) const {
    if (!comparison_.is_active()) return;
    const Placement placement(picture);
    ImGui::GetBackgroundDrawList()->AddLine(placement.at({comparison_.split, 0}),
                                            placement.at({comparison_.split, 1}),
                                            IM_COL32(255, 255, 255, 200));
}

void ComparisonPanel::draw_controls(const Session& first) {
    if (!ImGui::CollapsingHeader("compare")) return;
    draw_choice(first);
    if (comparison_.is_building()) ImGui::TextUnformatted("building ...");
    if (!comparison_.message().empty()) ImGui::TextWrapped("%s", comparison_.message().c_str());
    if (comparison_.is_active()) draw_numbers(first);
}

void ComparisonPanel::draw_choice(const Session& first) {
    const std::string chosen = comparison_.is_active() ? comparison_.second().chapter().name : "none";
    if (ImGui::BeginCombo("beside", chosen.c_str())) {
        if (ImGui::Selectable("none")) comparison_.stop();
        const std::string same = first.chapter().name + ", with the settings of now";
        if (ImGui::Selectable(same.c_str())) comparison_.start(first, first.chapter().name);
        for (const std::string& chapter : comparison_.chapters())
            if (chapter != first.chapter().name && ImGui::Selectable(chapter.c_str()))
                comparison_.start(first, chapter);
        ImGui::EndCombo();
    }
    if (!comparison_.is_active()) return;
    int equal = static_cast<int>(comparison_.equal);
    ImGui::RadioButton("equal time", &equal, static_cast<int>(Equal::time));
    ImGui::SameLine();
    ImGui::RadioButton("equal samples", &equal, static_cast<int>(Equal::samples));
    comparison_.equal = static_cast<Equal>(equal);
    ImGui::SliderFloat("split", &comparison_.split, 0, 1, "%.2f");
}

void ComparisonPanel::draw_numbers(const Session& first) const {
    const Session& second = comparison_.second();
    const auto row = [](const char* side, const Session& session) {
        const auto error = session.relative_error();
        ImGui::Text("%s %.6g samples, %s, error %s", side, session.samples(),
                    duration_text(session.seconds()).c_str(),
                    error ? (short_number(100 * *error) + " %").c_str() : "not known yet");
    };
    row("left: ", first);
    row("right:", second);
    if (const auto difference = comparison_.difference(first))
        ImGui::Text("left - right: %+.2f %% ± %.2f %%", 100 * difference->value,
                    100 * 1.96 * difference->standard_error);
    if (const auto speedup = comparison_.speedup(first))
        ImGui::TextWrapped("to equal error, right takes %.3g times as long as left", *speedup);
    const uint32_t length = first.build().job.parameters.max_path_length,
                   other = second.build().job.parameters.max_path_length;
    if (length != other)
        ImGui::TextWrapped("paths end after %u bounces left, %u right: the images differ", length, other);
    if (!second.message().empty()) ImGui::TextWrapped("%s", second.message().c_str());
}

}  // namespace lab
