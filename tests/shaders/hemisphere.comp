#version 460
// sample_hemisphere() of an estimator for each pair of numbers and, of chapter 2, the density of each direction.
#include "inside/estimator_stub.glsl"
#include "lights.glsl"
bool is_occluded(Ray ray, float t_max) { return false; }
#include "path_trace.glsl"

struct Input {
    vec2 numbers;
    vec3 direction;
};
struct Result {
    vec3 direction;
    float density;  // of the input's direction
};

layout(scalar, binding = 0) writeonly buffer Results { Result results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { Input inputs[]; };

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    results[i].direction = sample_hemisphere(inputs[i].numbers);
#ifdef DENSITY
    results[i].density = get_hemisphere_density(inputs[i].direction);
#endif
}
