#include "support/course_chapters.h"

#include <set>

#include "rendering/chapter.h"

namespace lab {

std::vector<std::string> course_chapters() {
    std::vector<std::string> chapters;
    std::set<std::string> titles;
    for (const std::string& name : chapter_folders())
        if (titles.insert(load_chapter(name).title).second) chapters.push_back(name);
    return chapters;
}

}  // namespace lab
