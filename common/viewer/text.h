// Text of the panels.
#pragma once
#include <imgui.h>

#include <string>

namespace lab {

// Text with line breaks between its words, where the window ends. Dear ImGui alone also breaks numbers at their points and signs.
inline std::string broken_between_words(const std::string& text, float width) {
    std::string lines;
    size_t line = 0;  // where it starts
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find_first_of(" \n", at), text.size());
        lines.append(text, at, end - at);
        const size_t space = lines.find_last_of(' ');
        if (space != std::string::npos && space > line && ImGui::CalcTextSize(&lines[line]).x > width) lines[space] = '\n';
        if (const size_t newline = lines.find_last_of('\n'); newline != std::string::npos) line = newline + 1;
        if (end < text.size()) lines += text[end];
        at = end + 1;
    }
    return lines;
}

inline void text_in_words(const std::string& text) {
    ImGui::TextWrapped("%s", broken_between_words(text, ImGui::GetContentRegionAvail().x).c_str());
}

}  // namespace lab
