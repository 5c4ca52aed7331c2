// Tracks a camera ray through the first medium: red is an estimate of its transmittance by ratio tracking, green tells whether delta
// tracking finds no collision, blue is the distance of the collision that it finds.
#define path_trace path_trace_of_chapter
#include "observed.glsl"
#undef path_trace

vec3 path_trace(Ray ray, inout uvec2 seed) {
    float flight = track_flight(media[0], ray, NO_LIMIT, seed);
    float transmittance = track_transmittance(media[0], ray, NO_LIMIT, seed);
    return vec3(transmittance, flight == NO_LIMIT, flight == NO_LIMIT ? 0.0 : flight);
}
