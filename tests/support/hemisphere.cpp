#include "support/hemisphere.h"

#include "support/render.h"

namespace lab {

std::vector<vec3> sample_hemisphere(const std::string& chapter, const std::vector<vec2>& numbers, const Device& device) {
    const TestShader shader{.name = "hemisphere.comp", .named_includes = named_includes(chapter_estimator(chapter))};
    return run_shader<vec3>(shader, numbers, device);
}

}  // namespace lab
