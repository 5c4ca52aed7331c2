#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// Chance that a path with this weight goes on.
vec3 get_survival(vec3 weight) {
    return min(weight / parameters.survival_weight, vec3(parameters.survival_cap));
}

// Estimates the light that the first hit reflects to the camera, by one path.
vec3 trace_branch(ShadingData s, inout uvec2 seed) {
    vec3 light = vec3(0.0);
    vec3 weight = vec3(1.0);
    for (uint k = 1u; k <= parameters.max_path_length; ++k) {
        if (!is_above_surface(s, s.out_direction)) return light;
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(k)) light += weight * direct_light;
        }
        if (STRATEGY != STRATEGY_BOUNCES && !HAS_BACKGROUND && k == parameters.max_path_length) return light;

        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) return light;
        weight *= PI * get_brdf(s, omega);

        // The path goes on with the chance of its strongest colour.
        if (k >= parameters.roulette_start) {
            vec3 q = get_survival(weight);
            if (!happens(max_component(q), seed)) return light;
            weight /= max(q, vec3(1e-3));
        }

        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            if (is_counted(k)) light += weight * get_background_radiance(omega);
            return light;
        }
        s = get_shading_data(hit, omega);
        if (STRATEGY == STRATEGY_BOUNCES && is_counted(k)) light += weight * s.emission;
    }
    return light;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    // The camera ray is traced once.
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.emission : vec3(0.0);

    float branch_weight = 1.0 / float(parameters.splitting_factor);
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch)
        radiance += branch_weight * trace_branch(s, seed);
    return radiance;
}
