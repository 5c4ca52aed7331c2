#version 460
// Runs an estimator at a surface point that sees a triangular light, without occluders or other lights.
#define FEATURE_LIGHT_TRIANGLES
#include "observation/estimator_stub.glsl"

struct Result {
    vec3 origin;     // of the shadow ray
    vec3 to_light;   // its direction, as long as the distance to the light
    float radiance;  // of the red channel
    uint shadow_rays;
};

layout(scalar, binding = 0) writeonly buffer Results { Result results[]; };
layout(scalar, binding = 1) readonly buffer Inputs {
    vec3 normal;
    vec3 out_direction;  // towards the camera
    Material material;
    uint max_path_length;
    uvec2 key;
    vec3 light_corners[3];
    Material light_material;
    LightTriangle light_triangles[];
};
#include "world/lights.glsl"

// In place of a backend.
Ray shadow_ray = Ray(vec3(0.0), vec3(0.0));
uint shadow_rays = 0u;
bool is_occluded(Ray ray, float t_max) {
    shadow_ray = ray;
    ++shadow_rays;
    return false;
}
#include "path_trace.glsl"

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= results.length()) return;
    set_surface(normal, material, max_path_length);
    parameters.background = vec3(0.0);
    for (uint corner = 0u; corner < 3u; ++corner) positions[3u + corner] = light_corners[corner];
    materials[1] = light_material;
    uvec2 seed = random_start_state(i, 0u, key);
    vec3 radiance = path_trace(Ray(out_direction, -out_direction), seed);
    vec3 to_light = shadow_ray.direction / (1.0 - 64.0 * ROUNDING);  // get_ray_to_point() ends that much short of it
    results[i] = Result(shadow_ray.origin, to_light, radiance.r, shadow_rays);
}
