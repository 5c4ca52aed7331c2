// Traces the recorded rays of a path and nothing else: the rate that a backend reaches without shading. Returns a hash
// of the hits, so that no compiler can leave the work out.
#include "recorded_ray.h"

layout(scalar, set = 0, binding = BINDING_RECORDED_RAYS) buffer RecordedRays { RecordedRay recorded_rays[]; };

RecordedRay get_recorded_ray(uint slot) { return recorded_rays[PATH_COUNT * slot + PATH_INDEX]; }

vec3 path_trace(Ray ray, inout uvec2 seed) {
    uint hash = 0u;
    for (uint slot = 0u; slot < MAX_RECORDED_RAYS; slot += 2u) {
        RecordedRay segment = get_recorded_ray(slot);
        if (segment.is_recorded == 0u) break;
        Hit hit;
        bool is_hit = trace_ray(Ray(segment.origin, segment.direction), segment.t_max, hit);
        hash = hash * 31u + (is_hit ? hit.triangle + 1u : 0u);
        RecordedRay shadow = get_recorded_ray(slot + 1u);
        if (shadow.is_recorded != 0u && is_occluded(Ray(shadow.origin, shadow.direction), shadow.t_max)) hash += 7u;
    }
    return vec3(hash & 0xffffu);
}
