#include "support/chapters.h"

#include <algorithm>
#include <map>

#include "error.h"
#include "files/file.h"
#include "files/project_folder.h"
#include "scene/json_object.h"

namespace lab {
namespace {

struct Description {
    Chapter chapter;
    nlohmann::json tests;
};

// Suites ask all chapters for their parameters whenever a program starts, and each test starts one: so files are read once.
const Description& description_of(const std::string& chapter) {
    static std::map<std::string, Description> known;
    if (const auto found = known.find(chapter); found != known.end()) return found->second;
    const auto file = project_folder() / "chapters" / chapter / "chapter.json";
    const nlohmann::json content = parse_json(file.string(), read_file(file, 1 << 16));
    return known.emplace(chapter, Description{load_chapter(chapter), content.value("tests", nlohmann::json::object())})
        .first->second;
}

const Chapter& described(const std::string& chapter) { return description_of(chapter).chapter; }
const nlohmann::json& expectations(const std::string& chapter) { return description_of(chapter).tests; }

}  // namespace

std::string chapter_named(const std::string& name) {
    const auto found = std::ranges::find_if(
        all_chapters, [&](const std::string& folder) { return folder.substr(folder.find('_') + 1) == name; });
    return found == all_chapters.end() ? throw UserError("there is no chapter " + name) : *found;
}

bool samples_lights(const std::string& chapter) { return !described(chapter).strategies.empty(); }

bool weights_lights(const std::string& chapter) { return std::ranges::count(described(chapter).strategies, Strategy::both) > 0; }

bool handles_dielectrics(const std::string& chapter) { return described(chapter).handles.dielectrics; }

bool handles_microfacets(const std::string& chapter) { return described(chapter).handles.microfacets; }
bool has_light_paths(const std::string& chapter) { return described(chapter).handles.light_paths; }

bool has_option(const std::string& chapter, const std::string& option) {
    return std::ranges::count(described(chapter).options, option, &ChapterOption::name) > 0;
}

bool splits_paths(const std::string& chapter) { return has_option(chapter, "--splitting-factor"); }
bool has_roulette(const std::string& chapter) { return has_option(chapter, "--survival-cap"); }
bool is_pseudorandom(const std::string& chapter) { return !described(chapter).low_discrepancy; }
bool weighs_by_albedo(const std::string& chapter) { return expectations(chapter).value("weighs_by_albedo", false); }
bool repeats_another(const std::string& chapter) { return expectations(chapter).value("repeats_another", false); }

uint32_t chapter_seed(const std::string& chapter) {
    const auto place = std::ranges::find(all_chapters, chapter) - all_chapters.begin();
    return 1000 * static_cast<uint32_t>(place % 64 + 1);
}

std::vector<ReferenceCase> reference_cases() {
    std::vector<ReferenceCase> cases;
    for (const std::string& chapter : all_chapters)
        for (const auto& c : expectations(chapter).value("references", nlohmann::json::array()))
            cases.push_back({.chapter = chapter,
                             .reference = c.at("reference"),
                             .samples = c.at("samples"),
                             .largest_bias = c.at("largest_bias"),
                             .largest_tile_bias = c.value("largest_tile_bias", 0.9),
                             .has_heavy_tail = c.value("has_heavy_tail", false),
                             .runs_with_all = c.value("runs_with_all", false)});
    return cases;
}

bool Repetition::has(const std::string& what) const { return std::ranges::count(without, what) == 0; }

std::vector<Repetition> repetitions() {
    std::vector<Repetition> all;
    for (const std::string& chapter : all_chapters)
        if (const auto said = expectations(chapter); said.contains("repeats"))
            all.push_back({chapter, chapter_named(said["repeats"].at("chapter")), said["repeats"].at("without")});
    return all;
}

}  // namespace lab
