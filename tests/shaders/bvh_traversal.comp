#version 460
// Traces given rays.
#extension GL_EXT_scalar_block_layout : require
#include "interface.h"
#include "world/ray.glsl"
#include "engine/trace_ray/compute.glsl"

layout(local_size_x = 128) in;

struct TestRay {
    vec3 origin;
    vec3 direction;
    float t_max;
};
struct TestHit {
    uint is_hit;
    uint is_occluded;
    uint instance;
    uint triangle;
    vec2 barycentrics;
    float distance;
};
layout(scalar, set = 0, binding = 0) writeonly buffer Results { TestHit results[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Inputs { TestRay inputs[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    Ray ray = Ray(inputs[i].origin, inputs[i].direction);
    Hit hit;
    bool is_hit = trace_ray(ray, inputs[i].t_max, hit);
    uint any_hit = uint(is_occluded(ray, inputs[i].t_max));
    if (is_hit)
        results[i] = TestHit(1u, any_hit, hit.instance, hit.triangle, hit.barycentrics, hit.distance);
    else
        results[i] = TestHit(0u, any_hit, 0u, 0u, vec2(0.0), 0.0);
}
