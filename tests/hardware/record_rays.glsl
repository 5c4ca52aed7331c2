// The benchmark's estimator, which also writes down the rays that it traces.
#include "recorded_ray.h"

layout(scalar, set = 0, binding = BINDING_RECORDED_RAYS) buffer RecordedRays { RecordedRay recorded_rays[]; };
uint recorded_count = 0u;

void record(Ray ray, float t_max, uint kind) {
    uint slot = PATH_COUNT * recorded_count++ + PATH_INDEX;
    recorded_rays[slot] = RecordedRay(ray.origin, t_max, ray.direction, kind);
}

bool record_and_trace_ray(Ray ray, float t_max, out Hit hit) {
    record(ray, t_max, CLOSEST_HIT);
    return trace_ray(ray, t_max, hit);
}

bool record_and_ask_is_occluded(Ray ray, float t_max) {
    record(ray, t_max, OCCLUSION);
    return is_occluded(ray, t_max);
}

#define trace_ray record_and_trace_ray
#define is_occluded record_and_ask_is_occluded
#include "../benchmark/path_trace.glsl"
