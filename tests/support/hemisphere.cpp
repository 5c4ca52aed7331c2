#include "support/hemisphere.h"

#include "support/render.h"

namespace lab {

std::vector<HemisphereAnswer> evaluate_hemisphere(const std::string& chapter,
                                                  const std::vector<HemisphereQuery>& queries,
                                                  const Device& device) {
    const Estimator estimator = chapter_estimator(chapter);
    TestShader shader{.name = "hemisphere.comp",
                      .defines = estimator.defines,
                      .named_includes = named_includes(estimator)};
    if (chapter == "02_cosine_sampling") shader.defines.emplace_back("DENSITY");
    return run_shader<HemisphereAnswer>(shader, queries, device);
}

}  // namespace lab
