#version 460
// Miss shader of the rays that look for the closest hit.
#include "ray.glsl"
#include "trace_ray/pipeline_payload.glsl"

layout(location = HIT_PAYLOAD) rayPayloadInEXT Hit hit_payload;

void main() { hit_payload.triangle = NO_TRIANGLE; }
