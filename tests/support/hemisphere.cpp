#include "support/hemisphere.h"

#include "files/project_folder.h"

namespace lab {

std::vector<HemisphereAnswer> evaluate_hemisphere(const std::string& chapter,
                                                  const std::vector<HemisphereQuery>& queries,
                                                  const Device& device) {
    TestShader shader{.name = "hemisphere.comp"};
    shader.named_includes = {
        {"path_trace.glsl", project_folder() / "chapters" / chapter / "path_trace.glsl"}};
    if (chapter == "02_cosine_sampling") shader.defines = {"DENSITY"};
    return run_shader<HemisphereAnswer>(shader, queries, device);
}

}  // namespace lab
