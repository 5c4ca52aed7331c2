#version 460
// choose_light_triangle() for given random states, and for those of different samples.
#define FEATURE_LIGHT_SAMPLING
#include "inside/estimator_stub.glsl"

layout(scalar, binding = 0) writeonly buffer Results { uint results[]; };
layout(scalar, binding = 1) readonly buffer Inputs {
    uvec2 key;  // of the random start states, where none are given
    uvec2 states[STATE_COUNT];
    LightTriangle light_triangles[];
};
#include "lights.glsl"

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= results.length()) return;
    uvec2 seed = i < STATE_COUNT ? states[i] : random_start_state(i, 0u, key);
    results[i] = choose_light_triangle(seed).triangle;
}
