#version 460
// Runs an estimator at a surface point: which direction it samples, and with which weight.
#include "observation/estimator_stub.glsl"
#include "world/lights.glsl"
bool is_occluded(Ray ray, float t_max) { return false; }
#include "path_trace.glsl"

struct Bounce {
    vec3 direction;
    float weight;    // radiance of the red channel
    uint ray_count;  // 1 if the estimator rejected the direction
};

layout(scalar, binding = 0) writeonly buffer Results { Bounce results[]; };
layout(scalar, binding = 1) readonly buffer Inputs {
    vec3 normal;
    vec3 out_direction;  // towards the camera
    Material material;
    uint max_path_length;
    uvec2 key;      // of the random start states, if none are given
    uvec2 seeds[];  // random states in which the estimator starts
};

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= results.length()) return;
    set_surface(normal, material, max_path_length);
#ifdef SURVIVAL_CAP
    parameters.roulette_start = 1u;
    parameters.survival_cap = SURVIVAL_CAP;
#endif
    uvec2 seed = i < seeds.length() ? seeds[i] : random_start_state(i, 0u, key);
    vec3 radiance = path_trace(Ray(out_direction, -out_direction), seed);
    results[i] = Bounce(traced_direction, radiance.r, ray_count);
}
