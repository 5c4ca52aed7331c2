#version 460
// sample_hemisphere() of an estimator for each pair of numbers.
#include "observation/estimator_stub.glsl"
#include "world/lights.glsl"
bool is_occluded(Ray ray, float t_max) { return false; }
#include "path_trace.glsl"

layout(scalar, binding = 0) writeonly buffer Results { vec3 results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { vec2 inputs[]; };

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    results[i] = sample_hemisphere(inputs[i]);
}
