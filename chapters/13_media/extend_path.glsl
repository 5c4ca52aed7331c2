// The path loop in media. It stands here in full, since a flight, a collision and open boundaries come between the steps of chapter
// 7's: cut into pieces that both share, neither loop could be read from top to bottom.
#ifndef FEATURE_MEDIA
#include "07_multiple_importance_sampling/extend_path.glsl"
#else
#include "flights.glsl"
#include "smoke.glsl"
#include "medium.glsl"
#include "equiangular.glsl"
#include "scatter.glsl"

// What a path carries from bounce to bounce: as in chapter 7, and the medium that it is in.
struct Path {
    Ray ray;
    vec3 radiance;
    vec3 throughput;
    uint path_length;
    float radiance_scale;
    Receiver receiver;
    float bounce_density;
    uint medium;     // index of the one around the ray's origin
    float distance;  // from x_{k-1} to the ray's origin, through open boundaries
    // Where equiangular samples share the light of x_{k-1}, a collision: the segment that it lies on, else one of no length.
    Segment segment;
    float flight;  // t of x_{k-1}
};

// A path that begins with this camera ray, in the medium around the camera.
Path start_path(Ray ray) {
    return Path(ray, vec3(0.0), vec3(1.0), 0u, 1.0, NO_RECEIVER, 0.0, find_medium(ray), 0.0, Segment(ray, 0.0, 0u), 0.0);
}

// Adds light that the path finds, or will have found after some more bounces.
void add_light(inout Path path, uint bounces, vec3 radiance) {
    if (is_counted(path.path_length + bounces)) path.radiance += path.radiance_scale * path.throughput * radiance;
}

// Extends the path by one bounce and adds the radiance that it finds. Returns false where the path ends.
bool extend_path(inout Path path, inout uvec2 seed) {
    Hit hit;
    bool is_hit = trace_ray(path.ray, NO_LIMIT, hit);
    if (!is_hit && path.medium != 0u) return false;  // its mesh is not closed

    // A free flight along ω_{k-1} ends in a collision, or at the next surface. One that ends within rounding errors of a surface
    // ends there, so that hardly any collision lies behind it.
    Medium medium = get_medium(path.medium);
    float t_max = is_hit ? (1.0 - 64.0 * ROUNDING) * hit.distance : NO_LIMIT;
    float flight = NO_LIMIT;
    if (has_grid(medium)) flight = track_flight(medium, path.ray, t_max, seed);
    else if (medium.extinction > 0.0) flight = get_flight_depth(get_random_words(seed).x) / medium.extinction;
    bool is_collision = flight < t_max;
    vec3 weight = is_collision ? medium.albedo : vec3(1.0);

    // Lamps light the whole way, wherever the flight ends.
    Segment segment = Segment(path.ray, is_hit ? hit.distance : FARTHEST, path.medium);
    bool has_angles = STRATEGY != STRATEGY_BOUNCES && samples_angles(medium);
    if (has_angles && path.path_length < parameters.max_path_length) add_light(path, 1u, sample_segment(segment, seed));
    path.throughput *= weight;

    if (!is_hit && !is_collision) {
        float light_density = path.receiver.is_light_sampled ? get_background_density(path.ray.direction) : 0.0;
        float bounce_part = get_bounce_part(light_density, path.bounce_density);
        add_light(path, 0u, bounce_part * get_background_radiance(path.ray.direction));
        return false;
    }

    Sides sides = Sides(path.medium, path.medium);
    ShadingData s;
    if (is_collision) {
        s = get_medium_point(path.ray.origin + flight * path.ray.direction, path.ray.direction);
    } else {
        s = get_shading_data(hit, path.ray.direction);
        sides = get_sides(hit, path.ray.direction, path.medium);
        path.distance += hit.distance;
        if (is_open_boundary(hit)) {  // nothing happens here
            path.ray = get_ray_from_surface(s, path.ray.direction);
            path.medium = sides.beyond;
            return true;
        }
        path.throughput *= s.transmittance;
        float cos_light = dot(s.geometric_normal, s.out_direction);
        float light_density = 0.0;
        if (path.receiver.is_light_sampled)
            light_density = to_solid_angle(get_light_density(path.receiver, s), path.distance, cos_light);
        if (DISTANCE_SAMPLING == SAMPLES_ANGLES && path.segment.t_max > 0.0)
            light_density *= get_distance_ratio(get_angles(path.segment, s.position), get_medium(path.segment.medium).extinction,
                                                path.flight);
        add_light(path, 0u, get_bounce_part(light_density, path.bounce_density) * s.emission);
        if (!is_above_surface(s, s.out_direction)) return false;
    }
    if (path.path_length == parameters.max_path_length || path.throughput == vec3(0.0)) return false;

    count_scattering(s, path.radiance);

    // The direct light at x_k, at a surface or in the medium.
    path.receiver = get_receiver(s);
    if (path.receiver.is_light_sampled) add_light(path, 1u, sample_scattered_light(s, sides, seed));

    // Sample ω_k.
    BsdfSample bounce = sample_scattering(s, get_medium(sides.here), seed);
    if (bounce.weight == vec3(0.0)) return false;
    path.throughput *= bounce.weight;
    path.radiance_scale *= bounce.radiance_scale;
    path.bounce_density = STRATEGY == STRATEGY_LIGHT ? 0.0 : bounce.density;

    // Russian roulette with the survival probability q = min(max throughput / β_s, cap).
    if (path.path_length + 1u >= parameters.roulette_start) {
        float survival_probability = min(max_component(path.throughput) / parameters.survival_weight, parameters.survival_cap);
        if (!happens(survival_probability, seed)) return false;
        path.throughput /= survival_probability;
    }
    path.ray = get_ray_from_surface(s, bounce.direction);
    path.medium = get_side(sides, s, bounce.direction);
    path.distance = 0.0;
    path.segment = Segment(segment.ray, has_angles && is_collision ? segment.t_max : 0.0, segment.medium);
    path.flight = flight;
    ++path.path_length;
    return true;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Path path = start_path(ray);
    while (extend_path(path, seed)) {
    }
    return path.radiance;
}
#endif
