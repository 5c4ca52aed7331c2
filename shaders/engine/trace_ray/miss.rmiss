#version 460
// Miss shader of all rays: nothing is in the way.
#include "world/ray.glsl"
#include "engine/trace_ray/pipeline_payload.glsl"

layout(location = HIT_PAYLOAD) rayPayloadInEXT Hit hit_payload;

void main() { hit_payload.triangle = NO_TRIANGLE; }
