#version 460
// The barycentric coordinates of the light point that an estimator chooses, for each random state.
#define FEATURE_LIGHT_TRIANGLES
#include "observation/estimator_stub.glsl"

layout(scalar, binding = 0) writeonly buffer Results { vec2 results[]; };
layout(scalar, binding = 1) readonly buffer Inputs {
    LightTriangle light_triangles[1];
    uvec2 seeds[];
};
#include "world/lights.glsl"
bool is_occluded(Ray ray, float t_max) { return false; }

vec2 chosen_barycentrics;
LightPoint get_and_note_light_point(LightTriangle light, vec2 barycentrics) {
    chosen_barycentrics = barycentrics;
    return get_light_point(light, barycentrics);
}
#define get_light_point get_and_note_light_point
#include "path_trace.glsl"

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= results.length()) return;
    set_surface(vec3(0.0, 0.0, 1.0), Material(vec3(1.0), -1, vec3(0.0), 0.0, vec3(0.0), 0.0, vec3(0.0), 0.0), 1u);
    positions[3] = vec3(0.0, 0.0, 1.0);
    positions[4] = vec3(0.0, 1.0, 1.0);
    positions[5] = vec3(1.0, 0.0, 1.0);
    materials[1] = materials[0];
    Hit hit;
    trace_ray(Ray(vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, -1.0)), NO_LIMIT, hit);
    ShadingData s = get_shading_data(hit, vec3(0.0, 0.0, -1.0));
    uvec2 seed = seeds[i];
    sample_direct_light(s, seed);
    results[i] = chosen_barycentrics;
}
