// The descriptions of chapters: chapter.json.
#include "rendering/chapter.h"

#include <algorithm>

#include "files/project_folder.h"
#include "test_files.h"

namespace lab {
namespace {

TEST(Chapter, SaysWhatItsShaderDoes) {
    const auto names = course_chapters();
    EXPECT_GE(names.size(), 6u);
    const Chapter all = load_chapter("05_russian_roulette");
    for (const auto& name : names) {
        const Chapter chapter = load_chapter(name);
        const std::string shader = file_bytes(project_folder() / "chapters" / name / "path_trace.glsl");
        const auto mentions = [&](const std::string& word) { return shader.find(word) != std::string::npos; };
        EXPECT_EQ(chapter.light_sampling, mentions("LIGHT_SAMPLING")) << name;
        EXPECT_EQ(chapter.light_probe_sampling, mentions("LIGHT_PROBE_SAMPLING")) << name;
        EXPECT_EQ(chapter.strategies, mentions("BOUNCES_FIND_LIGHTS")) << name;
        EXPECT_EQ(chapter.dielectrics, mentions("is_dielectric")) << name;
        for (const ChapterOption& option : all.options) {
            std::string parameter = option.name.substr(2);
            std::replace(parameter.begin(), parameter.end(), '-', '_');
            const bool has_it = std::any_of(chapter.options.begin(), chapter.options.end(),
                                            [&](const auto& o) { return o.name == option.name; });
            EXPECT_EQ(has_it, mentions("parameters." + parameter)) << name << " " << option.name;
        }
    }
}

TEST(Chapter, HasDefaults) {
    const TestFolder folder;
    folder.write("chapter.json", "{\"title\": \"A title\"}");
    const Chapter chapter = load_chapter(folder.path().string());
    EXPECT_EQ(chapter.name, folder.path().string());
    EXPECT_EQ(chapter.title, "A title");
    EXPECT_EQ(chapter.default_scene, "cornell_box");
    EXPECT_FALSE(chapter.light_sampling || chapter.split_every_hit || chapter.unlimited_path_length ||
                 chapter.dielectrics);
    EXPECT_TRUE(chapter.options.empty());
}

TEST(Chapter, MistakesAreNamed) {
    const TestFolder folder;
    const auto load = [&] { load_chapter(folder.path().string()); };
    EXPECT_USER_ERROR(load(), "chapter.json");  // there is none
    const std::pair<const char*, const char*> mistakes[] = {
        {"{\"title\": \"A\",}", "chapter.json:1: "},
        {"[]", "chapter.json: the chapter must be an object"},
        {"{}", "\"title\" in the chapter is missing"},
        {"{\"title\": 3}", "\"title\" in the chapter must be a text"},
        {"{\"title\": \"A\", \"tilte\": \"B\"}", "unknown key \"tilte\""},
        {"{\"title\": \"A\", \"dielectrics\": 1}", "must be true or false"},
        {"{\"title\": \"A\", \"check\": {\"scenes\": []}}", "unknown key \"scenes\" in \"check\""},
        {"{\"title\": \"A\", \"options\": \"--survival-cap\"}", "must be a list"},
        {"{\"title\": \"A\", \"options\": [7]}", "has 7: use"},
        {"{\"title\": \"A\", \"options\": [\"--cap\"]}", "has \"--cap\": use --splitting-factor, "}};
    for (const auto& [text, words] : mistakes) {
        folder.write("chapter.json", text);
        EXPECT_USER_ERROR(load(), words);
    }
}

}  // namespace
}  // namespace lab
