// Compiles GLSL at run time with glslang, so that a shader can be edited without rebuilding the program.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace lab {

constexpr uint64_t max_shader_bytes = 1 << 20;  // of each file

struct ShaderSource {
    std::filesystem::path file;             // its ending names the stage: .comp, .rgen, .rmiss or .rchit
    std::vector<std::string> defines = {};  // "NAME" or "NAME value"
    // What #include "name" stands for. Other names are looked up beside the includer, in shaders/ and in
    // chapters/, and may not lead out of these files' folders, shaders/ and chapters/. A file is included
    // once, even where an #if skips it.
    std::map<std::string, std::filesystem::path> named_includes = {};
    // Changes the whole text before it is compiled, if there is anything to change; line by line the same.
    std::function<std::string(const std::string&)> edit = {};
};

// The shader's file and all that it includes. Throws UserError if one is missing or refused.
std::vector<std::filesystem::path> shader_files(const ShaderSource& source);

// SPIR-V 1.5 words, from the cache where the same text was compiled before.
// Throws UserError with lines of the form "file:line: message".
std::vector<uint32_t> compile_shader(const ShaderSource& source);

}  // namespace lab
