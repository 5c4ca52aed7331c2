#version 460
// The miss shader of all rays: nothing was hit.
#include "world/ray.glsl"
#include "engine/trace_ray/pipeline_payload.glsl"

layout(location = HIT_PAYLOAD) rayPayloadInEXT Hit hit_payload;

void main() { hit_payload.triangle = NO_TRIANGLE; }
