// Russian roulette with a single random number for the whole path. It is alive after k bounces while this number is
// below S_k, the probability to live that long, and then counts 1/S_k. S never grows, so a dead path stays dead.
//
// S_k = min(max β_k / β_s, cap · S_{k-1}) with the plain product β_k of all factors π ρ: as if at every bounce a new number
// were compared with S_k / S_{k-1}.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// Uniform in [0,1) with 48 bits: 24 would be too few for paths that hardly anyone survives.
float get_fine_random_number(inout uvec2 seed) {
    vec2 u = get_random_numbers(seed);
    return min(u.x + u.y / 16777216.0, 0.9999999);
}

vec3 trace_branch(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 product = vec3(1.0);  // β
    float alive = 1.0;         // S
    float fate = get_fine_random_number(seed);
    for (uint k = 1u; k <= parameters.max_path_length; ++k) {
        bool is_shown = is_counted(k);
        if (!is_above_surface(s, out_direction)) break;
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_shown) radiance += product / alive * direct_light;
        }
        if (STRATEGY != STRATEGY_BOUNCES && !HAS_BACKGROUND && k == parameters.max_path_length) break;

        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) break;
        product *= PI * get_brdf(s, omega);
        if (k >= parameters.roulette_start)
            alive = min(max_component(product) / parameters.survival_weight, parameters.survival_cap * alive);
        if (fate >= alive) break;

        Hit hit;
        bool is_hit = trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit);
        if (!is_hit) {
            if (is_shown) radiance += product / alive * get_background_radiance(omega);
            break;
        }
        s = get_shading_data(hit, omega);
        out_direction = -omega;
        if (STRATEGY == STRATEGY_BOUNCES && is_shown) radiance += product / alive * s.emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 total = vec3(0.0);
    uint branch = 0u;
    do {
        total += trace_branch(s, -ray.direction, seed);
    } while (++branch < parameters.splitting_factor);
    return total / float(branch) + (is_counted(0u) ? s.emission : vec3(0.0));
}
