#version 460
// Miss shader of shadow rays: nothing is in the way.
#include "trace_ray/pipeline_payload.glsl"

layout(location = SHADOW_PAYLOAD) rayPayloadInEXT bool shadow_payload;

void main() { shadow_payload = false; }
