// The descriptions of chapters: chapter.json.
#include "rendering/chapter.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "files/project_folder.h"
#include "rendering/settings.h"
#include "support/course_chapters.h"
#include "test_files.h"

namespace lab {
namespace {

// Text of a chapter's shaders in this folder, including those that it takes from other chapters.
std::string shader_text(const Chapter& chapter, const std::string& folder = "/chapters/") {
    std::string text;
    for (const auto& file : shader_files(estimator_of(chapter)))
        if (file.generic_string().find(folder) != std::string::npos) text += file_bytes(file);
    return text;
}

TEST(Chapter, SaysWhatItsShaderDoes) {
    const auto names = course_chapters();
    EXPECT_GE(names.size(), 6u);
    std::map<std::string, ChapterOption> options;
    for (const auto& name : names)
        for (const ChapterOption& option : load_chapter(name).options) options.emplace(option.name, option);
    for (const auto& name : names) {
        const Chapter chapter = load_chapter(name);
        const std::string text = shader_text(chapter);
        const auto mentions = [&](const std::string& word) { return text.find(word) != std::string::npos; };
        const auto has_strategy = [&](Strategy strategy) { return std::ranges::count(chapter.strategies, strategy) > 0; };
        EXPECT_EQ(has_strategy(Strategy::light), mentions("STRATEGY_BOUNCES")) << name;
        EXPECT_EQ(has_strategy(Strategy::both), mentions("STRATEGY_LIGHT")) << name;
        EXPECT_EQ(chapter.handles.light_probe_sampling, mentions("choose_probe_cell")) << name;
        EXPECT_EQ(chapter.handles.dielectrics, mentions("is_dielectric")) << name;
        EXPECT_EQ(chapter.handles.microfacets, mentions("microfacets[")) << name;
        EXPECT_EQ(chapter.handles.lens, mentions("aperture_radius")) << name;
        EXPECT_EQ(chapter.handles.media, mentions("get_medium(")) << name;
        EXPECT_EQ(chapter.handles.light_paths, mentions("add_splat(")) << name;
        EXPECT_EQ(chapter.low_discrepancy, mentions("get_random_words(inout uvec2 seed) {")) << name;
        const std::string all = shader_text(chapter, "/shaders/") + text;
        for (const ChapterChoice& choice : chapter.choices) {
            if (choice.is_filter()) {  // of a shader of its own
                const std::string filter = read_file(project_folder() / "chapters" / name / "filter.glsl", 1 << 16);
                for (size_t i = 1; i < choice.values.size(); ++i)
                    EXPECT_TRUE(filter.find("#define " + choice.values[i].second + " ") != std::string::npos) << name << " " << i;
                continue;
            }
            EXPECT_TRUE(mentions("#define " + choice.define() + " " + choice.values.front().second))
                << "the default of " << choice.name;
            for (const auto& [_, value] : choice.values)
                EXPECT_TRUE(std::isdigit(static_cast<unsigned char>(value.front())) ||
                            all.find("const uint " + value + " =") != std::string::npos)
                    << value;
        }
        for (const auto& [option_name, option] : options) {
            std::string parameter = option_name.substr(2);
            std::ranges::replace(parameter, '-', '_');
            const bool has_it = std::ranges::count(chapter.options, option_name, &ChapterOption::name) > 0;
            EXPECT_EQ(has_it, mentions("parameters." + parameter)) << name << " " << option_name;
        }
    }
}

TEST(Chapter, GetsWhatItLacksFromTheOneThatItContinues) {
    int own = 0, others = 0;
    for (const auto& name : course_chapters()) {
        const Chapter chapter = load_chapter(name);
        if (chapter.continues.empty()) continue;
        const auto files = named_includes(estimator_of(chapter));
        for (const auto& [include, file] : named_includes(estimator_of(load_chapter(chapter.continues)))) {
            const auto place = project_folder() / "chapters" / name / include;
            const bool is_own = std::filesystem::exists(place);
            EXPECT_EQ(files.at(include), is_own ? place : file) << name;
            ++(is_own ? own : others);
        }
    }
    EXPECT_GT(own, 0);
    EXPECT_GT(others, 0);
}

TEST(Chapter, MistakesAreNamed) {
    const TestFolder folder;
    const auto load = [&] { load_chapter(folder.path().string()); };
    EXPECT_USER_ERROR(load(), "chapter.json");  // the file does not exist
    const std::pair<const char*, const char*> mistakes[] = {
        {"{\"title\": \"A\",}", "chapter.json:1: "},
        {"[]", "chapter.json: the chapter must be an object"},
        {"{}", "\"title\" in the chapter is missing"},
        {"{\"title\": 3}", "\"title\" in the chapter must be a text"},
        {"{\"title\": \"A\", \"tilte\": \"B\"}", "unknown key \"tilte\""},
        {"{\"title\": \"A\", \"dielectrics\": 1}", "must be true or false"},
        {"{\"title\": \"A\", \"check\": {\"scenes\": []}}", "unknown key \"scenes\" in \"check\""},
        {"{\"title\": \"A\", \"continues\": \"00_nothing\"}", "is \"00_nothing\": name the folder of an earlier chapter"},
        {"{\"title\": \"A\", \"strategies\": [\"brdf\"]}", "has \"brdf\": use both, light, bounces"},
        {"{\"title\": \"A\", \"options\": \"--survival-cap\"}", "must be a list"},
        {"{\"title\": \"A\", \"options\": [7]}", "has 7: use"},
        {"{\"title\": \"A\", \"options\": [\"--cap\"]}", "has \"--cap\": use --splitting-factor, "},
        {"{\"title\": \"A\", \"choices\": [{\"help\": \"B\", \"values\": []}]}", "\"name\" in a choice is missing"},
        {"{\"title\": \"A\", \"choices\": [{\"name\": \"B\", \"help\": \"C\", \"values\": []}]}", "must begin with --"},
        {"{\"title\": \"A\", \"choices\": [{\"name\": \"--b\", \"help\": \"C\", \"values\": []}]}", "is empty"},
        {"{\"title\": \"A\", \"choices\": [{\"name\": \"--b\", \"help\": \"C\", \"values\": [[\"d\"]]}]}",
         "has [\"d\"]: use pairs"}};
    for (const auto& [text, words] : mistakes) {
        folder.write("chapter.json", text);
        EXPECT_USER_ERROR(load(), words);
    }
}

}  // namespace
}  // namespace lab
