// What the code of a shader does, read from its SPIR-V.
#pragma once
#include <set>
#include <string>

#include "gpu/shader_compiler.h"

namespace lab {

// The code after the optimiser of SPIRV-Tools has removed what cannot be reached, as drivers do; glslang
// keeps it.
struct ShaderCode {
    std::set<uint32_t> bindings;              // of all resources, also of those that are declared only
    std::set<std::string> functions;          // those of the asked ones that can be reached
    std::set<std::string> material_members;   // those of Material that are read
    std::set<std::string> parameter_members;  // those of RenderParameters that are read
    bool reads_images = false;                // textures or a light probe
    bool has_samplers = false;                // of which some devices allow sixteen
    size_t instructions = 0;                  // in the bodies of all functions

    // Adds what another shader of the same pipeline does.
    void merge(const ShaderCode& other);
};

// `functions`: names that are looked for.
ShaderCode read_code(const ShaderSource& source, const std::set<std::string>& functions = {});

}  // namespace lab
