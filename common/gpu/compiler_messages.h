// What the shader compiler says, for people who write their first shader.
#pragma once
#include <string>

namespace lab {

// The errors in a log of glslang as lines "file:line: text", the first one of each line of source, since the
// others follow from it. The commonest say what to do.
std::string readable_errors(const std::string& log);

}  // namespace lab
