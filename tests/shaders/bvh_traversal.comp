#version 460
// Traces given rays, or with AIM_AT_TRIANGLES rays of its own from inside a closed mesh to its vertices and edges.
#extension GL_EXT_scalar_block_layout : require
#include "interface.h"
#include "world/random.glsl"
#include "world/ray.glsl"
#include "engine/trace_ray/compute.glsl"

layout(local_size_x = 128) in;

#ifdef AIM_AT_TRIANGLES
layout(scalar, push_constant) uniform AimParameters {
    vec3 centre;        // the rays start in the cube around this point,
    float half_extent;  // within this distance along each axis
    uint triangle_count;
    uint rays;  // a multiple of three in each invocation
    uint seed;
};
layout(scalar, set = 0, binding = 0) buffer Escapes { uint escapes[3]; };  // to vertices, edges and interiors

void main() {
    uvec2 state = random_start_state(gl_GlobalInvocationID.x, seed, uvec2(0u));
    for (uint i = 0u; i < rays; ++i) {
        vec2 u = get_random_numbers(state), v = get_random_numbers(state), w = get_random_numbers(state);
        int row = 3 * int(min(uint(u.x * float(triangle_count)), triangle_count - 1u));
        mat3 vertices = transpose(mat3(fetch_triangle_row(row), fetch_triangle_row(row + 1), fetch_triangle_row(row + 2)));
        uint kind = i % 3u;
        vec3 target = vertices[0];
        if (kind > 0u) target += v.x * (vertices[1] - vertices[0]);
        if (kind > 1u) target += (1.0 - v.x) * v.y * (vertices[2] - vertices[0]);
        vec3 origin = centre + half_extent * (2.0 * vec3(w, u.y) - 1.0);
        Hit hit;
        if (!trace_ray(Ray(origin, target - origin), NO_LIMIT, hit)) atomicAdd(escapes[kind], 1u);
    }
}
#else
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
#endif
