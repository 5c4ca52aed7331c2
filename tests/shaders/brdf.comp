#version 460
// get_brdf() and is_above_surface() for each pair of directions at a surface point.
#define FEATURE_SPECULAR
#include "observation/estimator_stub.glsl"

struct Input {
    vec3 normal;
    vec3 in_direction;
    vec3 out_direction;
    Material material;
};
struct Result {
    vec3 brdf;
    uint is_above;  // the in-direction
};

layout(scalar, binding = 0) writeonly buffer Results { Result results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { Input inputs[]; };

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    set_surface(inputs[i].normal, inputs[i].material, 1u);
    Hit hit;
    trace_ray(Ray(inputs[i].out_direction, -inputs[i].out_direction), NO_LIMIT, hit);
    ShadingData s = get_shading_data(hit, -inputs[i].out_direction);
    results[i].brdf = get_brdf(s, inputs[i].in_direction);
    results[i].is_above = is_above_surface(s, inputs[i].in_direction) ? 1u : 0u;
}
