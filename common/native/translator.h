// Translates GLSL to C++: a compute shader becomes a struct whose globals are members.
#pragma once
#include <string>

namespace lab::native {

// `glsl` is preprocessed and has been compiled without errors. Lines keep their numbers, by #line directives. Throws UserError
// for what this translator does not know.
std::string translate(const std::string& glsl);
// The same for several invocations at once. Empty for a shader that uses what lanes lack.
std::string translate_for_lanes(const std::string& glsl);

}  // namespace lab::native
