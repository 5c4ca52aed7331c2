// Wraps a chapter's estimator and records what it does for one sample of one pixel.
//
// trace_ray(), is_occluded() and add_splat() are replaced here, and start_sample() and finish_sample() in sample_loop.glsl. After the
// estimator's assignments to `throughput`, `radiance`, `survival_probability` and `flight`, common/inspection/recording_calls.cpp has
// inserted calls of the functions record_…() below.
#include "observation/recorded_path.h"
#include "observation/recorded_events.glsl"

bool is_recording = false;

// Whether the next event is recorded, and where it goes.
bool add_event(uint kind, out uint index) {
    if (!is_recording || !has_room(event_count++, index)) return false;
    events[index].kind = kind;
    return true;
}

void record_ray(uint kind, Ray ray, bool is_hit, float end, Hit hit) {
    uint i;
    if (!add_event(kind, i)) return;
    events[i].origin = ray.origin;
    events[i].direction = ray.direction;
    events[i].is_hit = is_hit ? 1u : 0u;
    events[i].end = end;
    events[i].flight = NO_FLIGHT;
    if (kind == EVENT_SHADOW_RAY || !is_hit) return;
    events[i].instance = hit.instance;
    events[i].triangle = hit.triangle;
    events[i].barycentrics = hit.barycentrics;
}

bool record_and_trace_ray(Ray ray, float t_max, out Hit hit) {
    bool is_hit = trace_ray(ray, t_max, hit);
    record_ray(EVENT_RAY, ray, is_hit, t_max, hit);
    return is_hit;
}

bool record_and_ask_is_occluded(Ray ray, float t_max) {
    bool is_hit = is_occluded(ray, t_max);
    Hit unused;
    record_ray(EVENT_SHADOW_RAY, ray, is_hit, t_max, unused);
    return is_hit;
}

void record_value(uint kind, vec3 value, uint variable) {
    uint i;
    if (!add_event(kind, i)) return;
    events[i].value = value;
    events[i].variable = variable;
}
void record_throughput(uint kind, vec3 throughput) { record_value(kind, throughput, 0u); }
void record_throughput(uint kind, float throughput) { record_value(kind, vec3(throughput), 0u); }
void record_radiance(uint kind, vec3 radiance, uint variable) { record_value(kind, radiance, variable); }
// A flight belongs to the latest ray.
void record_flight(float flight) {
    uint i;
    if (is_recording && event_count > 0u && has_room(event_count - 1u, i)) events[i].flight = flight;
}
void record_survival(float probability) { record_value(EVENT_SURVIVAL, vec3(probability), 0u); }

// At one place for all hits, since drivers compile a function again for every call.
void add_shading_data() {
    for (uint number = 0u; number < event_count; ++number) {
        uint i;
        if (!has_room(number, i) || events[i].kind != EVENT_RAY || events[i].is_hit == 0u) continue;
        Hit hit;
        hit.instance = events[i].instance;
        hit.triangle = events[i].triangle;
        hit.barycentrics = events[i].barycentrics;
        ShadingData s = get_shading_data(hit, events[i].direction);
        events[i].position = s.position;
        events[i].normal = s.normal;
    }
}

#ifdef SPLATS
// In place of add_splat(): nothing reaches the film.
void record_and_keep_splat(uvec2 pixel, vec3 radiance, uint sample_index) { record_value(EVENT_SPLAT, radiance, 0u); }
#define add_splat record_and_keep_splat
#endif

#define trace_ray record_and_trace_ray
#define is_occluded record_and_ask_is_occluded
#include "observed.glsl"
