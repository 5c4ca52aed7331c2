// trace_ray() by the ray tracing pipeline: the driver calls a closest-hit or miss shader of the shader binding table.
// They only fill a payload. The loop over the path stays in the ray generation shader, so the recursion depth is 1.
#include "engine/trace_ray/pipeline_payload.glsl"

layout(set = 0, binding = BINDING_ACCELERATION_STRUCTURE) uniform accelerationStructureEXT acceleration_structure;
layout(location = HIT_PAYLOAD) rayPayloadEXT Hit hit_payload;

// The driver finds the hit record at instance offset + ray type offset + geometry index · stride.
const uint RECORD_STRIDE = 1u;

// Finds the closest hit nearer than t_max, and returns whether there is one.
bool trace_ray(Ray ray, float t_max, out Hit hit) {
    ++ray_count;
    traceRayEXT(acceleration_structure, gl_RayFlagsOpaqueEXT, 0xffu, 0u, RECORD_STRIDE, MISS_RECORD, ray.origin, 0.0,
                ray.direction, t_max, HIT_PAYLOAD);
    hit = hit_payload;
    return hit.triangle != NO_TRIANGLE;
}

// Whether anything is hit nearer than t_max: no hit shader runs, and only the miss shader reports that nothing was hit.
bool is_occluded(Ray ray, float t_max) {
    ++ray_count;
    hit_payload.triangle = 0u;  // any triangle
    traceRayEXT(acceleration_structure,
                gl_RayFlagsOpaqueEXT | gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xffu,
                0u, RECORD_STRIDE, MISS_RECORD, ray.origin, 0.0, ray.direction, t_max, HIT_PAYLOAD);
    return hit_payload.triangle != NO_TRIANGLE;
}
