// Chapter 4, splitting: s branches from the first hit, then their mean.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// One branch: what the first hit reflects.
vec3 trace_branch(ShadingData s, inout uvec2 seed) {
    vec3 result = vec3(0.0);
    vec3 weight = vec3(1.0);
    uint k = 1u;
    while (k <= parameters.max_path_length) {
        if (!is_above_surface(s, s.out_direction)) return result;

        // direct light
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct = sample_direct_light(s, seed);
            if (is_counted(k)) result += weight * direct;
            // nothing can be found any more by the last ray
            if (!HAS_BACKGROUND && k == parameters.max_path_length) return result;
        }

        // bounce
        vec2 u = get_random_numbers(seed);
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(u);
        if (!is_above_surface(s, omega)) return result;
        weight *= PI * get_brdf(s, omega);

        // next hit
        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            if (is_counted(k)) result += weight * get_background_radiance(omega);
            return result;
        }
        s = get_shading_data(hit, omega);
        if (STRATEGY == STRATEGY_BOUNCES && is_counted(k)) result += weight * s.emission;
        ++k;
    }
    return result;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) {
        if (is_counted(0u)) return get_background_radiance(ray.direction);
        return vec3(0.0);
    }
    ShadingData s = get_shading_data(hit, ray.direction);

    vec3 radiance = vec3(0.0);
    if (is_counted(0u)) radiance += s.emission;
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch) {
        radiance += trace_branch(s, seed);
    }
    return radiance / float(parameters.splitting_factor);
}
