#include "rendering/chapter_folder.h"

#include <algorithm>
#include <filesystem>

#include "files/file.h"
#include "files/project_folder.h"

namespace lab {

std::vector<std::string> chapter_folders() {
    std::vector<std::string> names;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(project_folder() / "chapters", none))
        if (std::filesystem::exists(entry.path() / "path_trace.glsl"))
            names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

Chapter chapter_in_folder(const std::string& name) {
    const auto shader = project_folder() / "chapters" / name / "path_trace.glsl";
    const std::string text = read_file(shader, 1 << 24);
    const auto mentions = [&](const char* word) { return text.find(word) != std::string::npos; };
    Chapter chapter{.name = name, .title = name};
    chapter.light_sampling = mentions("LIGHT_SAMPLING");
    chapter.dielectrics = mentions("is_dielectric");
    if (mentions("parameters.splitting_factor")) chapter.options.push_back(splitting_factor);
    if (mentions("parameters.survival_cap")) chapter.options.push_back(survival_cap);
    if (mentions("parameters.roulette_start")) chapter.options.push_back(roulette_start);
    return chapter;
}

}  // namespace lab
