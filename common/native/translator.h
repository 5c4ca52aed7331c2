// Translates GLSL to C++: a compute shader becomes a struct whose globals are members.
#pragma once
#include <string>

namespace lab::native {

// `glsl` is preprocessed and has been compiled without errors. Lines keep their numbers, by #line directives. Throws UserError
// for what this translator does not know.
std::string translate(const std::string& glsl);
// The same for several invocations at once. Where the shader uses what lanes lack, `refusal` says so.
std::string translate_for_lanes(const std::string& glsl, std::string& refusal);

}  // namespace lab::native
