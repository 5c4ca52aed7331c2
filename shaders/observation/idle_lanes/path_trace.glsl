// A view: the fraction of time that a pixel's thread waits while other threads of its group trace rays.
// Threads that execute the same instruction together are the lanes of a subgroup.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require

// How many rays this thread traces, and how often its group traces with this thread as the first active one.
uint own_steps = 0u, group_steps = 0u;

bool count_and_trace_ray(Ray ray, float t_max, out Hit hit) {
    ++own_steps;
    if (subgroupElect()) ++group_steps;
    return trace_ray(ray, t_max, hit);
}

#define trace_ray count_and_trace_ray
#include "observed.glsl"
#undef trace_ray
