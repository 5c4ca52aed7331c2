#version 460
// FUNCTION(x, y) for each pair of numbers, as the device computes it.
#extension GL_EXT_scalar_block_layout : require

layout(scalar, binding = 0) writeonly buffer Results { float results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { vec2 inputs[]; };

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < inputs.length()) results[i] = FUNCTION(inputs[i].x, inputs[i].y);
}
