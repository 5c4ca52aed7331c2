const uint SAMPLES_FLIGHTS = 0u;
const uint SAMPLES_ANGLES = 1u;
#ifndef DISTANCE_SAMPLING
#define DISTANCE_SAMPLING SAMPLES_FLIGHTS
#endif
bool samples_angles(Medium medium) { return DISTANCE_SAMPLING == SAMPLES_ANGLES && !has_grid(medium); }

const float FARTHEST = 1e18;
const float FARTHEST_DEPTH = 80.0;

struct Segment {
    Ray ray;
    float t_max;
    uint medium;
};

// Kulla and Fajardo: D is the distance from the light to the line, delta the t of the foot.
struct Angles {
    float delta;
    float D;
    float theta_a;
    float theta_b;
};

Angles get_angles(Segment segment, vec3 y) {
    vec3 to_y = y - segment.ray.origin;
    float delta = dot(to_y, segment.ray.direction);
    float D = max(length(to_y - delta * segment.ray.direction), ROUNDING * length(to_y));
    return Angles(delta, D, atan(-delta / D), atan((segment.t_max - delta) / D));
}

float sample_distance(Angles a, float t_max, float u) {
    float t = a.D * tan(mix(a.theta_a, a.theta_b, u));
    return clamp(a.delta + t, 0.0, t_max);
}

// pdf(t) over that of free flights
float get_distance_ratio(Angles a, float extinction, float t) {
    float pdf = a.D / ((a.theta_b - a.theta_a) * (a.D * a.D + t * t));
    return pdf * exp(min(extinction * t, FARTHEST_DEPTH)) / extinction;
}
