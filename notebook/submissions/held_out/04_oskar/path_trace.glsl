#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// All in one function: an outer loop over branches and an inner one over bounces.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData first = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? first.emission : vec3(0.0);

    vec3 branches = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch) {
        ShadingData s = first;
        for (uint k = 1u; k <= parameters.max_path_length; ++k) {
            if (!is_above_surface(s, s.out_direction)) break;
            if (STRATEGY != STRATEGY_BOUNCES) {
                vec3 direct = sample_direct_light(s, seed);
                if (is_counted(k)) branches += throughput * direct;
                if (!HAS_BACKGROUND && k == parameters.max_path_length) break;
            }
            vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
            if (!is_above_surface(s, omega)) break;
            throughput *= PI * get_brdf(s, omega);
            if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
                if (is_counted(k)) branches += throughput * get_background_radiance(omega);
                break;
            }
            s = get_shading_data(hit, omega);
            if (STRATEGY == STRATEGY_BOUNCES && is_counted(k)) branches += throughput * s.emission;
        }
    }
    return radiance + branches / float(parameters.splitting_factor);
}
