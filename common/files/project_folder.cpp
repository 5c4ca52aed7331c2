#include "files/project_folder.h"

#include "error.h"
#include "platform.h"

namespace lab {

std::filesystem::path project_folder() {
    static const std::filesystem::path found = [] {
        for (std::filesystem::path folder = running_program().parent_path(); folder != folder.root_path();
             folder = folder.parent_path())
            if (std::filesystem::exists(folder / "shaders" / "interface.h")) return folder;
        return std::filesystem::path();
    }();
    if (found.empty())
        throw UserError(
            "cannot find the folder shaders/ above the program: unpack the whole archive, and keep build/ in "
            "it");
    return found;
}

}  // namespace lab
