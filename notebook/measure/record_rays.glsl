// An estimator that also records the rays it traces: those of one path per pixel.
#include "replay/recorded_ray.h"

layout(scalar, set = 0, binding = BINDING_RECORDED_RAYS) buffer RecordedRays { RecordedRay recorded_rays[]; };
uint next_segment = 0u;

void record(Ray ray, float t_max, uint slot) {
    recorded_rays[PATH_COUNT * slot + PATH_INDEX] = RecordedRay(ray.origin, t_max, ray.direction, 1u);
}

bool record_and_trace_ray(Ray ray, float t_max, out Hit hit) {
    record(ray, t_max, 2u * next_segment++);
    return trace_ray(ray, t_max, hit);
}

bool record_and_ask_is_occluded(Ray ray, float t_max) {
    record(ray, t_max, 2u * next_segment - 1u);
    return is_occluded(ray, t_max);
}

#define trace_ray record_and_trace_ray
#define is_occluded record_and_ask_is_occluded
#include "observed.glsl"
