#version 460
// choose_light_triangle() for given random states, and for those of different samples. With ONE_PAIR a single pair of words
// chooses both the triangle and the point on it.
#define FEATURE_LIGHT_TRIANGLES
#include "observation/estimator_stub.glsl"

struct Choice {
    uint triangle;
    vec2 u;  // of the point on it
};

layout(scalar, binding = 0) writeonly buffer Results { Choice results[]; };
layout(scalar, binding = 1) readonly buffer Inputs {
    uvec2 key;  // of the random start states, if none are given
    uvec2 states[STATE_COUNT];
    LightTriangle light_triangles[];
};
#include "world/lights.glsl"

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= results.length()) return;
    uvec2 seed = i < STATE_COUNT ? states[i] : random_start_state(i, 0u, key);
#ifdef LARGEST_DIGITS
    uint entry = i % uint(light_triangles.length());
    results[i].u = vec2(0.0);
    results[i].triangle = uint(gives_way(0xffffffffu, light_triangles[entry].threshold, results[i].u.x));
    return;
#endif
#ifdef ONE_PAIR
    results[i].triangle = choose_light_triangle(seed, results[i].u).triangle;
#else
    results[i].triangle = choose_light_triangle(seed).triangle;
    results[i].u = get_random_numbers(seed);
#endif
}
