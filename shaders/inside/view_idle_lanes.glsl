// A view: the part of its time in which a pixel's thread waits for others of its group while they trace rays, 0 for never
// to 1 for always. Threads that execute the same instruction together are the lanes of a subgroup.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require

// How often this thread traces, and how often its group does while this thread is the first of those that do.
uint own_steps = 0u, group_steps = 0u;

bool count_and_trace_ray(Ray ray, float t_max, out Hit hit) {
    ++own_steps;
    if (subgroupElect()) ++group_steps;
    return trace_ray(ray, t_max, hit);
}

#define trace_ray count_and_trace_ray
#include "inside/observed_estimator.glsl"
#undef trace_ray

// The chapter renders some samples of a camera ray in its own way: one after the other, or one as soon as the last one of
// the thread has ended.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    const uint samples = 16u;
    uvec2 state = seed;
#ifdef OBSERVED_PATH_REGENERATION
    ObservedPath path;
    bool is_path_alive = false;
    for (uint i = 0u; is_path_alive || i < samples;) {
        if (!is_path_alive) {
            state = random_start_state(seed.x, i, seed);
            path = observed_start_path(ray);
            ++i;
        }
        is_path_alive = observed_extend_path(path, state);
    }
#else
    for (uint i = 0u; i < samples; ++i) {
        state = random_start_state(seed.x, i, seed);
        observed_path_trace(ray, state);
    }
#endif
    uint steps = subgroupAdd(group_steps);
    return vec3(float(steps - own_steps) / float(steps));  // a difference first: never below 0
}
