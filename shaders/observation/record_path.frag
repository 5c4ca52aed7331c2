#version 460
// Records a path in a browser, as path_recorder.cpp does in the programs. An event has 24 words: the first row of pixels has one half of
// them, the second row the other.
#include "interface.h"
#include "world/scene.glsl"

#define LIMITED_LOOPS
DispatchParameters dispatch;

#include "world/ray.glsl"
#include "engine/trace_ray/compute.glsl"

#include "engine/render_samples.glsl"

const uint web_stuck = 0x80000000u;  // with the place of a loop that does not end, in place of an event's kind
const uint web_no_event = 0x7fffffffu;
layout(location = 0) out uvec4 web_event_words_0;
layout(location = 1) out uvec4 web_event_words_1;
layout(location = 2) out uvec4 web_event_words_2;

void main() {
    kept_event = uint(gl_FragCoord.x);
    events[0].kind = web_no_event;
    samples_with_own_loops = 2u;
    render_samples(uvec2(recorded_pixel % parameters.image_size.x, recorded_pixel / parameters.image_size.x), 0u, 1u, 1u);

    RecordedEvent event = events[0];
    if (web_stuck_place != 0u) event.kind = web_stuck | web_stuck_place;
    uvec3 value = floatBitsToUint(event.value), origin = floatBitsToUint(event.origin);
    uvec3 direction = floatBitsToUint(event.direction);
    uvec3 position = floatBitsToUint(event.position), normal = floatBitsToUint(event.normal);
    if (gl_FragCoord.y < 1.0) {
        web_event_words_0 = uvec4(event.kind, event.variable, value.xy);
        web_event_words_1 = uvec4(value.z, origin);
        web_event_words_2 = uvec4(direction, floatBitsToUint(event.end));
    } else {
        web_event_words_0 = uvec4(floatBitsToUint(event.flight), event.is_hit, event.instance, event.triangle);
        web_event_words_1 = uvec4(floatBitsToUint(event.barycentrics), position.xy);
        web_event_words_2 = uvec4(position.z, normal);
    }
}
