// Splitting at every hit, as in the blog: each of s branches splits again into s branches, so that s^k of them reach
// x_{k+1}. Most of the work then goes into long paths, which carry the least light. Russian roulette prunes this tree.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

const uint MAX_SPLIT_PATH_LENGTH = 8u;  // longer paths end here

// A hit from which branches still have to start. A shader cannot call itself, so these wait on a stack.
struct SplitHit {
    ShadingData s;
    vec3 throughput;
    float branch_weight;  // of each branch: 1/s for every split so far
    uint branches_left;
};

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.emission : vec3(0.0);

    SplitHit stack[MAX_SPLIT_PATH_LENGTH];
    float split_weight = 1.0 / float(parameters.splitting_factor);
    uint max_path_length = min(parameters.max_path_length, MAX_SPLIT_PATH_LENGTH);
    stack[0] = SplitHit(s, vec3(1.0), split_weight, parameters.splitting_factor);
    // The stack holds x_1, x_2, ..., x_k with k = path_length. Light that arrives at x_k has been reflected k times.
    uint path_length = min(max_path_length, 1u);
    while (path_length > 0u) {
        uint top = path_length - 1u;
        if (stack[top].branches_left == 0u) {
            --path_length;
            continue;
        }
        --stack[top].branches_left;
        s = stack[top].s;
        vec3 throughput = stack[top].throughput;
        float branch_weight = stack[top].branch_weight;

        // The direct light at x_k.
        if (!is_above_surface(s, s.out_direction)) continue;
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length)) radiance += branch_weight * throughput * direct_light;
        }
        if (STRATEGY != STRATEGY_BOUNCES && !HAS_BACKGROUND && path_length == max_path_length) continue;

        // Sample ω_k with density n·ω_k / π with respect to solid angle. The weight is π ρ.
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) continue;
        throughput *= PI * get_brdf(s, omega);

        // Russian roulette with the survival probability q = min(max throughput / β_s, cap), without the split's 1/s.
        if (path_length >= parameters.roulette_start) {
            float survival_probability =
                min(max_component(throughput) / parameters.survival_weight, parameters.survival_cap);
            if (!happens(survival_probability, seed)) continue;
            throughput /= survival_probability;
        }

        // Trace the ray x_k, ω_k. Its hit splits in turn.
        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += branch_weight * throughput * get_background_radiance(omega);
            continue;
        }
        s = get_shading_data(hit, omega);
        if (STRATEGY == STRATEGY_BOUNCES && is_counted(path_length)) radiance += branch_weight * throughput * s.emission;
        if (path_length == max_path_length) continue;
        stack[path_length] = SplitHit(s, throughput, branch_weight * split_weight, parameters.splitting_factor);
        ++path_length;
    }
    return radiance;
}
