#version 460
// The chapter's free flights through a homogeneous medium, for given states of the random number generator.
#extension GL_EXT_scalar_block_layout : require
#include "interface.h"
#include "world/constants.glsl"
#include "world/random.glsl"
#include "flights.glsl"

struct Input {
    uvec2 seed;
    float extinction;
};

layout(scalar, binding = 0) writeonly buffer Results { float results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { Input inputs[]; };

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    uvec2 seed = inputs[i].seed;
    results[i] = get_flight_depth(get_random_words(seed).x) / inputs[i].extinction;
}
