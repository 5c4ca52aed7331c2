// A view: the part of its time in which the thread of a pixel waits for others of its group while they trace rays, from 0
// for never to 1 for always. Threads that execute the same instruction together are the lanes of a subgroup.
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require

// How often this thread traces a ray, and how often its group does while this thread is the first of those that do.
uint own_steps = 0u, group_steps = 0u;

bool count_and_trace_ray(Ray ray, float t_max, out Hit hit) {
    ++own_steps;
    if (subgroupElect()) ++group_steps;
    return trace_ray(ray, t_max, hit);
}

#define trace_ray count_and_trace_ray
#include "observed.glsl"
#undef trace_ray
