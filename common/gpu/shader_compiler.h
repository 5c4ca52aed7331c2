// Compiles GLSL at run time with glslang, so that shaders can be edited without rebuilding the program.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace lab {

constexpr uint64_t max_shader_bytes = 1 << 20;  // per file

using Replacements = std::map<std::filesystem::path, std::filesystem::path>;

struct ShaderSource {
    std::filesystem::path file;             // stage by extension: .comp, .rgen, .rmiss or .rchit
    std::vector<std::string> defines = {};  // "NAME" or "NAME value"
    // Files for #include "name". Other names are looked up next to the including file, in shaders/ and in chapters/, and must not
    // lead outside the folders of these files, shaders/ and chapters/. Each file is included once, even if an #if skips it.
    std::map<std::string, std::filesystem::path> named_includes = {};
    // Files that are read instead of others, by the canonical paths of those. They include as if they were there, and then what
    // is next to themselves.
    Replacements replacements = {};
    // Edits the text before it is compiled; lines keep their numbers.
    std::function<std::string(const std::string&)> edit = {};
};

// The shader's file and everything it includes, by canonical path, and for each the file that is read, mostly itself. Throws
// UserError if one is missing or refused.
std::map<std::filesystem::path, std::filesystem::path> shader_files(const ShaderSource& source);

// Returns SPIR-V 1.5, from the cache if possible; it says the line of each instruction if `has_lines`. Throws UserError with
// lines "file:line: message".
std::vector<uint32_t> compile_shader(const ShaderSource& source, bool has_lines = false);

}  // namespace lab
