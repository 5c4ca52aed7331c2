#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

vec3 trace_branch(ShadingData s, inout uvec2 seed) {
    vec3 L = vec3(0.0);
    vec3 beta = vec3(1.0);
    for (uint depth = 1u; depth <= parameters.max_path_length; ++depth) {
        if (!is_above_surface(s, s.out_direction)) break;

        // Terminate paths that carry little, before anything is paid for them.
        float q = 1.0;
        if (depth > parameters.roulette_start) {
            q = min(max_component(beta) / parameters.survival_weight, parameters.survival_cap);
            if (!happens(q, seed)) break;
        }
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 Ld = sample_direct_light(s, seed);
            if (is_counted(depth)) L += beta * Ld;
            if (!HAS_BACKGROUND && depth == parameters.max_path_length) break;
        }

        vec3 wi = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, wi)) break;
        beta *= PI * get_brdf(s, wi) / q;

        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, wi), NO_LIMIT, hit)) {
            if (is_counted(depth)) L += beta * get_background_radiance(wi);
            break;
        }
        s = get_shading_data(hit, wi);
        if (STRATEGY == STRATEGY_BOUNCES && is_counted(depth)) L += beta * s.emission;
    }
    return L;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 L = vec3(0.0);
    for (uint i = 0u; i < parameters.splitting_factor; ++i) L += trace_branch(s, seed);
    L /= float(parameters.splitting_factor);
    if (is_counted(0u)) L += s.emission;
    return L;
}
