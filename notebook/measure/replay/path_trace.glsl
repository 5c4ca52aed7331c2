// Only traces recorded rays: the rate that a backend reaches without shading. Returns a hash of the hits, so that no compiler can
// optimise the work away.
#include "recorded_ray.h"

layout(scalar, set = 0, binding = BINDING_RECORDED_RAYS) readonly buffer RecordedRays { RecordedRay recorded_rays[]; };

// Paths that this thread has replayed. Each sample replays the path of a different block of pixels: with the same path in every
// sample, a thread with a long path would be late every time. Where threads do not wait for each other after a sample, as in the
// ray tracing pipeline, that made the rate look half as high.
uint replayed_paths = 0u;

// State of a path's replay between rays.
struct Path {
    vec3 radiance;
    uint index;
    uint slot;
};

Path start_path(Ray ray) { return Path(vec3(0.0), (PATH_INDEX + 64u * replayed_paths++) % PATH_COUNT, 0u); }

bool extend_path(inout Path path, inout uvec2 seed) {
    RecordedRay segment = recorded_rays[PATH_COUNT * path.slot + path.index];
    Hit hit;
    bool is_hit = trace_ray(Ray(segment.origin, segment.direction), segment.t_max, hit);
    uint hash = is_hit ? hit.triangle + 1u : 0u;
    RecordedRay shadow = recorded_rays[PATH_COUNT * (path.slot + 1u) + path.index];
    if (shadow.is_recorded != 0u && is_occluded(Ray(shadow.origin, shadow.direction), shadow.t_max)) hash += 7u;
    path.radiance += vec3(hash & 0xffffu);
    path.slot += 2u;
    return path.slot < MAX_RECORDED_RAYS && recorded_rays[PATH_COUNT * path.slot + path.index].is_recorded != 0u;
}
