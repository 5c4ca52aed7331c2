// Traces recorded rays and does nothing else: the rate that a backend reaches without shading. Returns a hash of the
// hits, so that no compiler can leave the work out.
#include "recorded_ray.h"

layout(scalar, set = 0, binding = BINDING_RECORDED_RAYS) readonly buffer RecordedRays { RecordedRay recorded_rays[]; };

// Paths that this thread has replayed. Each sample is the path of another block of pixels: with the same path in each
// sample, a thread whose path is long would be late in all of them. Where threads do not wait for each other after a
// sample, as in the ray tracing pipeline, that made the rate look half as high.
uint replayed_paths = 0u;

vec3 path_trace(Ray ray, inout uvec2 seed) {
    uint path = (PATH_INDEX + 64u * replayed_paths++) % PATH_COUNT;
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
