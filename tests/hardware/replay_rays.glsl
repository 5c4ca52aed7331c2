// Traces the recorded rays of a path and nothing else: the rate that a backend reaches without shading. Returns a hash
// of the hits, so that no compiler can leave the work out.
#include "recorded_ray.h"

layout(scalar, set = 0, binding = BINDING_RECORDED_RAYS) buffer RecordedRays { RecordedRay recorded_rays[]; };

vec3 path_trace(Ray ray, inout uvec2 seed) {
    uint hash = 0u;
    for (uint i = 0u; i < MAX_RECORDED_RAYS; ++i) {
        RecordedRay recorded = recorded_rays[PATH_COUNT * i + PATH_INDEX];
        if (recorded.kind == NO_RAY) break;
        Hit hit;
        hit.triangle = 0u;
        bool is_hit = recorded.kind == OCCLUSION
                          ? is_occluded(Ray(recorded.origin, recorded.direction), recorded.t_max)
                          : trace_ray(Ray(recorded.origin, recorded.direction), recorded.t_max, hit);
        hash = hash * 31u + (is_hit ? hit.triangle + 1u : 0u);
    }
    return vec3(hash & 0xffffu);
}
