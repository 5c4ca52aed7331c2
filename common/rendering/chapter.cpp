#include "rendering/chapter.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "files/file.h"
#include "files/project_folder.h"
#include "scene/json_object.h"

namespace lab {
namespace {

// All options that chapters may have: name, help, parameter, default, smallest and largest value. The defaults are measured, see
// docs/results.md.
const std::vector<ChapterOption>& chapter_options() {
    using Parameters = RenderParameters;
    static const std::vector<ChapterOption> all{
        {"--splitting-factor", "Branches in which a path goes on", &Parameters::splitting_factor, 4, 1, 1024},
        {"--survival-cap", "Largest survival probability of Russian roulette; with 1, paths among white walls never end",
         &Parameters::survival_cap, 0.95, 0.001, 1},
        {"--survival-weight", "Throughput below which Russian roulette ends paths, and which survivors have",
         &Parameters::survival_weight, 0.5, 0.001, 1},
        {"--roulette-start", "Bounce at which Russian roulette begins", &Parameters::roulette_start, 3, 1, 1000000}};
    return all;
}

std::vector<ChapterOption> read_options(const JsonObject& chapter) {
    std::vector<ChapterOption> options;
    if (!chapter.has("options")) return options;
    for (const nlohmann::json& name : chapter.array("options")) {
        const auto& all = chapter_options();
        const auto found = std::find_if(all.begin(), all.end(), [&](const auto& o) { return name == o.name; });
        if (found == all.end()) {
            std::string known;
            for (const ChapterOption& option : all) known += (known.empty() ? "" : ", ") + option.name;
            chapter.fail("options", "has " + name.dump() + ": use " + known);
        }
        options.push_back(*found);
    }
    return options;
}

std::vector<Strategy> read_strategies(const JsonObject& chapter) {
    std::vector<Strategy> strategies;
    if (!chapter.has("strategies")) return strategies;
    for (const nlohmann::json& name : chapter.array("strategies")) {
        const auto found = std::find_if(all_strategies.begin(), all_strategies.end(),
                                        [&](Strategy strategy) { return name == to_string(strategy); });
        if (found == all_strategies.end()) chapter.fail("strategies", "has " + name.dump() + ": use both, light, bounces");
        strategies.push_back(*found);
    }
    return strategies;
}

std::vector<ChapterChoice> read_choices(const JsonObject& chapter, const std::string& file) {
    std::vector<ChapterChoice> choices;
    if (!chapter.has("choices")) return choices;
    for (const nlohmann::json& content : chapter.array("choices")) {
        const JsonObject choice(content, file, "a choice", {"name", "help", "values", "shows", "chooses_material", "passes"});
        choices.push_back({choice.required("name", choice.text("name")),
                           choice.required("help", choice.text("help")),
                           {},
                           choice.text("shows").value_or(""),
                           choice.boolean("chooses_material").value_or(false)});
        if (!choices.back().name.starts_with("--")) choice.fail("name", "must begin with --");
        for (const nlohmann::json& value : choice.array("values")) {
            if (!value.is_array() || value.size() != 2 || !value[0].is_string() || !value[1].is_string())
                choice.fail("values", "has " + value.dump() + ": use pairs of a word and what the shader calls it");
            choices.back().values.emplace_back(value[0], value[1]);
        }
        if (choices.back().values.empty()) choice.fail("values", "is empty: the first value is the default");
        if (!choice.has("passes")) continue;
        for (const nlohmann::json& count : choice.array("passes")) {
            if (!count.is_number_unsigned() || count > 100) choice.fail("passes", "has " + count.dump() + ": use 0 to 100");
            choices.back().passes.push_back(count);
        }
        if (choices.back().passes.size() != choices.back().values.size())
            choice.fail("passes", "must have one number for each value");
    }
    return choices;
}

// The chapter must come earlier, so that no two continue each other.
std::string read_continued(const JsonObject& chapter, const std::string& name) {
    const std::string continued = chapter.text("continues").value_or("");
    if (continued.empty()) return continued;
    const auto names = chapter_folders();
    if (continued >= name || std::ranges::find(names, continued) == names.end())
        chapter.fail("continues", "is " + in_quotes(continued) + ": name the folder of an earlier chapter");
    load_chapter(continued);  // whose own may be wrong
    return continued;
}

}  // namespace

std::string ChapterChoice::define() const {
    std::string define = name.substr(2);
    for (char& letter : define) letter = letter == '-' ? '_' : static_cast<char>(std::toupper(letter));
    return define;
}

std::vector<std::string> chapter_folders() {
    std::vector<std::string> names;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(project_folder() / "chapters", none))
        if (std::filesystem::exists(entry.path() / "chapter.json")) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

Chapter load_chapter(const std::string& name) {
    const auto file = project_folder() / "chapters" / name / "chapter.json";
    const nlohmann::json content = parse_json(file.string(), read_file(file, 1 << 16));
    const JsonObject root(content, file.string(), "the chapter",
                          {"title", "continues", "default_scene", "strategies", "light_probe_sampling", "unlimited_path_length",
                           "dielectrics", "microfacets", "lens", "media", "light_tree", "light_paths", "low_discrepancy",
                           "options", "choices", "check", "exercise", "tests", "measure"});
    // The last four are for others: tools/check/grading.py, tools/course/handout.py, tests/support/chapters.cpp,
    // tools/report/studies.py.
    if (root.has("check"))
        root.object("check", {"samples", "references", "other_references", "gains_over", "passed_by_placeholder"});
    const Chapter defaults;
    return {.name = name,
            .title = root.required("title", root.text("title")),
            .continues = read_continued(root, name),
            .default_scene = root.text("default_scene").value_or(defaults.default_scene),
            .strategies = read_strategies(root),
            .unlimited_path_length = root.boolean("unlimited_path_length").value_or(false),
            .handles = {.light_probe_sampling = root.boolean("light_probe_sampling").value_or(false),
                        .dielectrics = root.boolean("dielectrics").value_or(false),
                        .microfacets = root.boolean("microfacets").value_or(false),
                        .lens = root.boolean("lens").value_or(false),
                        .media = root.boolean("media").value_or(false),
                        .light_tree = root.boolean("light_tree").value_or(false),
                        .light_paths = root.boolean("light_paths").value_or(false)},
            .low_discrepancy = root.boolean("low_discrepancy").value_or(false),
            .options = read_options(root),
            .choices = read_choices(root, file.string())};
}

}  // namespace lab
