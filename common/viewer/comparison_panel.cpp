#include "viewer/comparison_panel.h"

#include <imgui.h>

#include <algorithm>

#include "rendering/numbers_text.h"
#include "viewer/inspection_drawing.h"
#include "viewer/text.h"

namespace lab {
namespace {

void draw_choice(Comparison& comparison, const Session& first) {
    const std::string chosen = comparison.is_active() ? comparison.second().chapter().name : "none";
    if (ImGui::BeginCombo("beside", chosen.c_str())) {
        if (ImGui::Selectable("none")) comparison.stop();
        const std::string same = first.chapter().name + ", with the settings of now";
        if (ImGui::Selectable(same.c_str())) comparison.start(first, first.chapter().name);
        for (const std::string& chapter : comparison.chapters())
            if (chapter != first.chapter().name && ImGui::Selectable(chapter.c_str())) comparison.start(first, chapter);
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
        text_in_words(side + (" " + samples_text(session.samples())) + " samples per pixel in " +
                      duration_text(session.seconds()) + (session.is_filtered() ? ", error " : ", noise ") +
                      (error ? short_number(100 * *error) + " %" : "not known yet"));
    };
    row("left:", first);
    row("right:", second);
    if (const auto difference = comparison.difference(first))
        ImGui::Text("left - right: %+.2f %% ± %.2f %%", 100 * difference->value, 100 * 1.96 * difference->standard_error);
    if (const auto speedup = comparison.speedup(first))
        ImGui::TextWrapped("to equal error, right takes %.3g times as long as left", *speedup);
    const uint32_t length = first.build().job.parameters.max_path_length, other = second.build().job.parameters.max_path_length;
    if (length != other) ImGui::TextWrapped("paths end after %u bounces left, %u right: the images differ", length, other);
    if (!second.message().empty()) ImGui::TextWrapped("%s", second.message().c_str());
}

}  // namespace

std::string half_label(const Session& session, const Session& other) {
    std::string label = session.chapter().name;
    std::replace(label.begin(), label.end(), '_', ' ');  // allows line breaks
    if (session.chapter().name != other.chapter().name) return label;
    const std::string flags = session.build().job.header.settings + " --", others = other.build().job.header.settings + " --";
    for (size_t from = 0, to; (to = flags.find(" --", from)) != std::string::npos; from = to + 1)
        if (others.find(flags.substr(from, to - from) + " --") == std::string::npos)
            label += "\n" + flags.substr(from, to - from);
    return label;
}

void draw_halves(const Comparison& comparison, const Session& first, const Rectangle& picture) {
    if (!comparison.is_active()) return;
    const Placement placement(picture);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddLine(placement.at({comparison.split, 0}), placement.at({comparison.split, 1}), IM_COL32(255, 255, 255, 200));
    const auto draw_label = [&](const std::string& label, float from, float to) {
        const ImVec2 corner = placement.at({from, 0}), end = placement.at({to, 1});
        const float margin = 0.3f * ImGui::GetFontSize(), width = end.x - corner.x - 2 * margin;
        if (width < ImGui::GetFontSize()) return;  // this half is almost invisible
        const ImVec2 size = ImGui::CalcTextSize(label.c_str(), nullptr, false, width);
        list.PushClipRect(corner, end, true);
        list.AddRectFilled(corner, {corner.x + size.x + 2 * margin, corner.y + size.y + 2 * margin}, IM_COL32(0, 0, 0, 160));
        list.AddText(nullptr, 0, {corner.x + margin, corner.y + margin}, IM_COL32_WHITE, label.c_str(), nullptr, width);
        list.PopClipRect();
    };
    const Session& second = comparison.second();
    draw_label(half_label(first, second), 0, comparison.split);
    draw_label(half_label(second, first), comparison.split, 1);
}

void draw_controls(Comparison& comparison, const Session& first) {
    if (!ImGui::CollapsingHeader("compare")) return;
    draw_choice(comparison, first);
    if (comparison.is_building()) ImGui::TextUnformatted("building ...");
    if (!comparison.message().empty()) ImGui::TextWrapped("%s", comparison.message().c_str());
    if (comparison.is_active()) draw_numbers(comparison, first);
}

}  // namespace lab
