// A shader as the native backend gets it.
#pragma once
#include "gpu/shader_compiler.h"
#include "test_files.h"

namespace lab {

// `glsl` without its first lines; its own are those of test.glsl.
inline std::vector<uint32_t> compile_glsl(const std::string& glsl) {
    const TestFolder folder;
    const auto file = folder.write("test.comp",
                                   "#version 460\n#extension GL_EXT_scalar_block_layout : require\n"
                                   "#extension GL_EXT_samplerless_texture_functions : require\n#line 1 \"test.glsl\"\n" +
                                       glsl);
    return compile_shader({.file = file}, true);
}

}  // namespace lab
