// Chapter 4, splitting: the path continues from its first hit in s branches, each with weight 1/s.
//
// Let X be what a branch finds and h the first hit. Then Var(mean of s branches) = Var(E[X|h]) + E[Var(X|h)] / s: splitting
// lowers the variance of what comes after the first hit without paying for the camera ray again.
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

    // Split: all branches start at x_1.
    float branch_weight = 1.0 / float(parameters.splitting_factor);
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch) {
        uvec2 branch_seed = seed;
        radiance += branch_weight * trace_branch(s, branch_seed);
    }
    return radiance;
}
