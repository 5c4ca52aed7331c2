// What a shader's code does, according to its SPIR-V.
#pragma once
#include <set>
#include <string>

#include "gpu/shader_compiler.h"

namespace lab {

// The code after SPIRV-Tools' optimiser has removed what cannot be reached, as drivers do; glslang keeps it.
struct ShaderCode {
    std::set<uint32_t> bindings;              // of all resources, even those only declared
    std::set<std::string> functions;          // those asked for that are reachable
    std::set<std::string> material_members;   // those of Material that are read
    std::set<std::string> parameter_members;  // those of RenderParameters that are read
    bool reads_images = false;                // textures or a light probe
    bool has_samplers = false;                // some devices allow only sixteen
    size_t instructions = 0;                  // in the bodies of all functions

    // Adds another shader of the same pipeline.
    void merge(const ShaderCode& other);
};

// `functions`: names to look for.
ShaderCode read_code(const ShaderSource& source, const std::set<std::string>& functions = {});

}  // namespace lab
