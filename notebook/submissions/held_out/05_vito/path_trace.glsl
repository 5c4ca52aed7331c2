#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// 1/q of the roulette, at least 1/cap: survivors carry the survival weight unless the cap applies.
float get_survivor_factor(vec3 throughput) {
    return max(parameters.survival_weight / max_component(throughput), 1.0 / parameters.survival_cap);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData first = get_shading_data(hit, ray.direction);
    vec3 mean = vec3(0.0);
    const bool is_light_sampled = STRATEGY != STRATEGY_BOUNCES;

    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch) {
        ShadingData s = first;
        vec3 found = vec3(0.0), beta = vec3(1.0);
        uint k = 0u;
        while (k++ < parameters.max_path_length && is_above_surface(s, s.out_direction)) {
            // The direction is drawn first, the light sample takes the numbers that follow.
            vec2 u = get_random_numbers(seed);
            if (is_light_sampled) {
                vec3 direct = sample_direct_light(s, seed);
                if (is_counted(k)) found += beta * direct;
                if (!HAS_BACKGROUND && k == parameters.max_path_length) break;
            }
            vec3 omega = get_shading_space(s.normal) * sample_hemisphere(u);
            if (!is_above_surface(s, omega)) break;
            beta *= get_brdf(s, omega) * PI;
            if (beta == vec3(0.0)) break;
            if (k >= parameters.roulette_start) {
                float factor = get_survivor_factor(beta);
                if (!happens(1.0 / factor, seed)) break;
                beta *= factor;
            }
            if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
                if (is_counted(k)) found += beta * get_background_radiance(omega);
                break;
            }
            s = get_shading_data(hit, omega);
            if (!is_light_sampled && is_counted(k)) found += beta * s.emission;
        }
        mean += (found - mean) / float(branch + 1u);
    }
    return is_counted(0u) ? first.emission + mean : mean;
}
