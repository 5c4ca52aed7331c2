// Traces recorded rays and does nothing else: the rate that a backend reaches without shading. Returns a hash of the
// hits, so that no compiler can leave the work out.
#include "recorded_ray.h"

layout(scalar, set = 0, binding = BINDING_RECORDED_RAYS) readonly buffer RecordedRays { RecordedRay recorded_rays[]; };

vec3 path_trace(Ray ray, inout uvec2 seed) {
    // The samples of a pixel are paths of different blocks, so that all of them are replayed equally often.
    uint path = PATH_INDEX % PATH_COUNT;
    uint hash = 0u;
    for (uint slot = 0u; slot < MAX_RECORDED_RAYS; slot += 2u) {
        RecordedRay segment = recorded_rays[PATH_COUNT * slot + path];
        if (segment.is_recorded == 0u) break;
        Hit hit;
        bool is_hit = trace_ray(Ray(segment.origin, segment.direction), segment.t_max, hit);
        hash = hash * 31u + (is_hit ? hit.triangle + 1u : 0u);
        RecordedRay shadow = recorded_rays[PATH_COUNT * (slot + 1u) + path];
        if (shadow.is_recorded != 0u && is_occluded(Ray(shadow.origin, shadow.direction), shadow.t_max)) hash += 7u;
    }
    return vec3(hash & 0xffffu);
}
