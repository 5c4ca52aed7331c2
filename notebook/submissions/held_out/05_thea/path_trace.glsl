// Chapter 5, Russian roulette: after every bounce the path survives only with probability q, and then has weight 1/q.
//
// As q · (1/q) X + (1 - q) · 0 = X, the expectation stays the same, and paths of any length end after a finite number of bounces.
// q follows the throughput: dim paths cost as much as bright ones and contribute less. The throughput already holds the factors
// 1/q of earlier bounces, so all survivors carry about the survival weight β_s, however long they are.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// Estimates the light that the first hit x_1 reflects to the camera, by one path.
vec3 trace_branch(ShadingData s, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint path_length = 1u; path_length <= parameters.max_path_length; ++path_length) {
        // At x_k with k = path_length: the direct light, which arrives after k bounces.
        if (!is_above_surface(s, s.out_direction)) break;
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length)) radiance += throughput * direct_light;
        }
        // The last ray could only find the background, or lights that have been sampled.
        if (STRATEGY != STRATEGY_BOUNCES && !HAS_BACKGROUND && path_length == parameters.max_path_length) break;

        // Sample ω_k = Q ω(u) with density n·ω_k / π with respect to solid angle. The weight is π ρ.
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) break;
        throughput *= PI * get_brdf(s, omega);

        // Russian roulette: each colour channel has its survival probability, the path has the largest.
        if (path_length >= parameters.roulette_start) {
            vec3 q = min(throughput / parameters.survival_weight, vec3(parameters.survival_cap));
            if (!happens(max_component(q), seed)) break;
            throughput /= max(q, vec3(1e-6));
        }

        // Trace the ray x_k, ω_k to the next hit. If it misses all triangles, it sees the background.
        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += throughput * get_background_radiance(omega);
            break;
        }
        s = get_shading_data(hit, omega);
        if (STRATEGY == STRATEGY_BOUNCES && is_counted(path_length)) radiance += throughput * s.emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    // The camera ray is traced once.
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.emission : vec3(0.0);

    // Split: all branches start at x_1. The generator's state runs on, so their random numbers differ.
    float branch_weight = 1.0 / float(parameters.splitting_factor);
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch)
        radiance += branch_weight * trace_branch(s, seed);
    return radiance;
}
