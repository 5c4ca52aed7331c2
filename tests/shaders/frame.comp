#version 460
// get_shading_space() for each normal.
#extension GL_EXT_scalar_block_layout : require
#include "world/frame.glsl"

layout(scalar, binding = 0) writeonly buffer Results { mat3 results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { vec3 inputs[]; };

layout(local_size_x = 128) in;

void main() {
    if (gl_GlobalInvocationID.x < inputs.length())
        results[gl_GlobalInvocationID.x] = get_shading_space(inputs[gl_GlobalInvocationID.x]);
}
