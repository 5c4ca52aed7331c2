// Paths that begin at a lamp. Where they are at a surface that the camera sees, they send light there.
#include "connect_to_camera.glsl"

// Traces a path from a lamp, one for each camera path. It has random numbers of its own: camera paths draw theirs in the same order,
// whatever happens here.
void trace_light_path(uvec2 seed) {
    seed.y ^= 0x80000000u;
    // y_0: a uniform point on a triangle chosen with probability P, and a direction with density cos θ / π. What it carries is
    // L_e cos θ over both densities: π L_e A/P, the power of all lamps if they are of one colour.
    vec2 u;
    LightTriangle light = choose_light_triangle(seed, u);
    LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));
    vec3 power = PI * y.emission * light.inverse_density;
    if (HAS_LIGHT_PROBE_CELLS) power *= 1.0 - LIGHT_PROBE_PROBABILITY;  // the probability of a light sample, not of a light path
    Ray ray = Ray(y.position_in_front, get_shading_space(y.normal) * sample_hemisphere(get_random_numbers(seed)));

    vec3 throughput = vec3(1.0);
    for (uint bounces = 1u; bounces <= parameters.max_path_length; ++bounces) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) return;
        ShadingData s = get_shading_data(hit, ray.direction);
        throughput *= s.transmittance;
        if (!is_above_surface(s, s.out_direction)) return;
        if (bounces == 1u && !s.is_dielectric) return;  // light samples of camera paths find this light

        if (!s.is_dielectric && is_counted(bounces)) connect_to_camera(s, power * throughput, seed);

        // Go on as a camera path does. Power has no 1/η²: that belongs to radiance.
        BsdfSample bounce = sample_bsdf(s, seed);
        if (bounce.weight == vec3(0.0)) return;
        throughput *= bounce.weight * get_adjoint_factor(s, s.out_direction, bounce.direction);
        if (bounces >= parameters.roulette_start) {
            float survival_probability = min(max_component(throughput) / parameters.survival_weight, parameters.survival_cap);
            if (!happens(survival_probability, seed)) return;
            throughput /= survival_probability;
        }
        ray = get_ray_from_surface(s, bounce.direction);
    }
}
