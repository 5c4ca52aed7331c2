// Russian roulette and the next direction from the same two numbers: given that u < q, u/q is uniform in [0,1) again.
// The survival probability is decided before the direction is known, by the albedo instead of the factor of the
// bounce. It may depend on all that has happened until then.
#include "sampling.glsl"
#include "direct_light.glsl"

// Largest share of light that the surface can send on, whatever the direction.
vec3 get_albedo(ShadingData s) {
#ifdef FEATURE_SPECULAR
    return s.diffuse_albedo + s.specular_albedo;
#else
    return s.diffuse_albedo;
#endif
}

struct Walker {
    ShadingData s;
    vec3 out_direction;
    vec3 throughput;
    uint path_length;
    bool is_walking;
};

// Everything that happens at one vertex and on the way to the next. Returns the light that it adds.
vec3 walk(inout Walker w, inout uvec2 seed) {
    vec3 light = vec3(0.0);
    bool is_shown = is_counted(w.path_length);
    w.is_walking = false;
    if (!is_above_surface(w.s, w.out_direction)) return light;
    if (LIGHT_SAMPLING) {
        vec3 direct_light = sample_direct_light(w.s, w.out_direction, seed);
        if (is_shown) light += w.throughput * direct_light;
    }
    if (LIGHT_SAMPLING && !HAS_BACKGROUND && w.path_length == parameters.max_path_length) return light;

    vec2 u = get_random_numbers(seed);
    if (w.path_length >= parameters.roulette_start) {
        float expected = max_component(w.throughput * get_albedo(w.s));
        float survival_probability = min(expected, parameters.survival_cap);
        if (u.x >= survival_probability) return light;
        u.x = min(u.x / survival_probability, 0.9999999);
        w.throughput /= survival_probability;
    }
    vec3 omega = get_shading_space(w.s.normal) * sample_hemisphere(u);
    if (!is_above_surface(w.s, omega)) return light;
    w.throughput *= get_pi_brdf(w.s, omega, w.out_direction);

    Hit hit;
    if (!trace_ray(get_ray_from_surface(w.s, omega), NO_LIMIT, hit)) {
        if (is_shown) light += w.throughput * get_background_radiance(omega);
        return light;
    }
    w.s = get_shading_data(hit, omega);
    w.out_direction = -omega;
    if (!LIGHT_SAMPLING && is_shown) light += w.throughput * w.s.emission;
    w.is_walking = w.path_length < parameters.max_path_length;
    ++w.path_length;
    return light;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.emission : vec3(0.0);
    float split = float(parameters.splitting_factor);
    for (uint i = 0u; i < parameters.splitting_factor; ++i) {
        Walker walker = Walker(s, -ray.direction, vec3(1.0), 1u, parameters.max_path_length > 0u);
        while (walker.is_walking) radiance += walk(walker, seed) / split;
    }
    return radiance;
}
