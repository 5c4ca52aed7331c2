// Paths that begin at a lamp. Surfaces that they meet behind glass send the light on to the camera.
#include "connect_to_camera.glsl"

// What a light path carries from bounce to bounce.
struct LightPath {
    Ray ray;
    vec3 power;         // of all lamps
    vec3 throughput;    // what bounces have left of it
    uint path_length;   // bounces so far
    uint sample_index;  // of the camera path beside it
};

// A path that leaves a lamp at y_0: a uniform point on a triangle chosen with probability P, and a direction with density cos θ / π.
// It carries L_e cos θ over both densities, π L_e A/P: the power of all lamps, if they are of one colour.
LightPath start_light_path(uint sample_index, inout uvec2 seed) {
    seed.y ^= 0x80000000u;  // other numbers than the camera path's
    vec2 u;
    LightTriangle light = choose_light_triangle(seed, u);
    LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));
    vec3 power = PI * y.emission * light.inverse_density;
    if (HAS_LIGHT_PROBE_CELLS) power *= 1.0 - LIGHT_PROBE_PROBABILITY;  // A/P is that of light samples, some of which go to the probe
    vec3 omega = get_shading_space(y.normal) * sample_hemisphere(get_random_numbers(seed));
    return LightPath(Ray(y.position_in_front, omega), power, vec3(1.0), 0u, sample_index);
}

// Extends the path by one bounce, and sends light from there to the camera. Returns false where the path ends.
bool extend_light_path(inout LightPath path, inout uvec2 seed) {
    Hit hit;
    if (path.path_length == parameters.max_path_length || !trace_ray(path.ray, NO_LIMIT, hit)) return false;
    ++path.path_length;
    ShadingData s = get_shading_data(hit, path.ray.direction);
    path.throughput *= s.transmittance;
    if (!is_above_surface(s, s.out_direction)) return false;
    if (path.path_length == 1u && !s.is_dielectric) return false;  // light samples of camera paths find this light

    if (!s.is_dielectric && is_counted(path.path_length))
        connect_to_camera(s, path.power * path.throughput, path.sample_index, seed);

    // Go on like a camera path, but without 1/η²: that belongs to radiance, and this is power.
    BsdfSample bounce = sample_bsdf(s, seed);
    if (bounce.weight == vec3(0.0)) return false;
    path.throughput *= bounce.weight * get_adjoint_factor(s, s.out_direction, bounce.direction);
    if (path.path_length >= parameters.roulette_start) {
        float survival_probability = min(max_component(path.throughput) / parameters.survival_weight, parameters.survival_cap);
        if (!happens(survival_probability, seed)) return false;
        path.throughput /= survival_probability;
    }
    path.ray = get_ray_from_surface(s, bounce.direction);
    return true;
}
