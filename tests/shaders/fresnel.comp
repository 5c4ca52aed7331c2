#version 460
// get_fresnel_reflectance() and sample_dielectric() of chapter 6 for each surface and direction.
#include "observation/estimator_stub.glsl"
#include "world/lights.glsl"
bool is_occluded(Ray ray, float t_max) { return false; }
#include "path_trace.glsl"

struct Input {
    vec3 normal;
    vec3 out_direction;
    float eta;
    float eta_cos_theta_t;
    uvec2 seed;
};
struct Result {
    float reflectance;
    vec3 direction;
};

layout(scalar, binding = 0) writeonly buffer Results { Result results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { Input inputs[]; };

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    ShadingData s;
    s.normal = s.geometric_normal = inputs[i].normal;
    s.out_direction = inputs[i].out_direction;
    s.relative_index = inputs[i].eta;
    uvec2 seed = inputs[i].seed;
    float cos_theta = dot(s.normal, s.out_direction);
    results[i].reflectance = get_fresnel_reflectance(cos_theta, inputs[i].eta, inputs[i].eta_cos_theta_t);
    results[i].direction = sample_dielectric(s, seed).direction;
}
