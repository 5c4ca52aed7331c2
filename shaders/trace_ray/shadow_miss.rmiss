#version 460
// Miss shader of shadow rays: nothing is in the way.
#include "ray.glsl"
#include "trace_ray/pipeline_payload.glsl"

layout(location = HIT_PAYLOAD) rayPayloadInEXT Hit hit_payload;

void main() { hit_payload.triangle = NO_TRIANGLE; }
