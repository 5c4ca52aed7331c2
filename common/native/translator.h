// Translates shaders to C++, from what glslang makes of them.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace lab::native {

// `spirv` comes from compile_shader() with lines. The C++ has their numbers, by #line directives. With `for_lanes` it runs
// several invocations at once. Throws UserError for what this translator does not know.
std::string translate(const std::vector<uint32_t>& spirv, bool for_lanes);

}  // namespace lab::native
