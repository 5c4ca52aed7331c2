// Where a light sample is taken along a ray in a medium.
const uint SAMPLES_FLIGHTS = 0u;  // where the path collides
const uint SAMPLES_ANGLES = 1u;   // at a uniform angle, seen from the lamp
// Where light samples are taken: one of the constants above, which --distance-sampling chooses.
#ifndef DISTANCE_SAMPLING
#define DISTANCE_SAMPLING SAMPLES_FLIGHTS
#endif

// Whether light samples are taken at uniform angles. The formula needs a density of flights, which a grid does not have.
bool samples_angles(Medium medium) { return DISTANCE_SAMPLING == SAMPLES_ANGLES && !has_grid(medium); }

// Both keep products finite.
const float FARTHEST = 1e18;        // length of a segment without an end
const float FARTHEST_DEPTH = 80.0;  // beyond this optical depth no light counts

// The part of a ray that lies in one medium.
struct Segment {
    Ray ray;  // its direction has unit length
    float t_max;
    uint medium;
};

// Equiangular samples (Kulla and Fajardo, "Importance Sampling Techniques for Path Tracing in Participating Media", 2012): y sees a
// segment at the height h above its line, between the angles θ_a and θ_b of its ends.
struct Angles {
    float nearest;  // t of the line's point that is nearest to y
    float height;   // h
    float first;    // θ_a
    float size;     // θ_b - θ_a
};
// The angles of a segment, seen from y.
Angles get_angles(Segment segment, vec3 y) {
    vec3 to_y = y - segment.ray.origin;
    float nearest = dot(to_y, segment.ray.direction);
    float height = max(length(to_y - nearest * segment.ray.direction), ROUNDING * length(to_y));
    float size = atan(height * segment.t_max, height * height - nearest * (segment.t_max - nearest));
    return Angles(nearest, height, atan(-nearest, height), size);
}

// The distance t = t_y + h tan θ of a uniform angle. Its density with respect to length, h / ((θ_b - θ_a) (h² + (t - t_y)²)), is
// proportional to 1/r² of a light sample, which it cancels.
float sample_distance(Angles angles, float t_max, float u) {
    return clamp(angles.nearest + angles.height * tan(angles.first + u * angles.size), 0.0, t_max);
}

// The density of sample_distance() over that of free flights, σ_t exp(-σ_t t): the weights of both kinds of samples need no more.
float get_distance_ratio(Angles angles, float extinction, float t) {
    float from_nearest = t - angles.nearest;
    float density = angles.height / (angles.size * (angles.height * angles.height + from_nearest * from_nearest));
    return density * exp(min(extinction * t, FARTHEST_DEPTH)) / extinction;
}
