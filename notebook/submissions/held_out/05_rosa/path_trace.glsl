// Chapter 5: Russian roulette.
//
// The survival probability follows the luminance of the throughput, since this is what the eye notices. It stays above 5 %:
// otherwise a rare survivor would come back with an enormous weight.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

float luminance(vec3 colour) { return dot(colour, vec3(0.2126, 0.7152, 0.0722)); }

// Kills the path (returns true), or makes up for those that have been killed.
bool dies(inout vec3 throughput, inout uvec2 seed) {
    float q = clamp(luminance(throughput) / parameters.survival_weight, 0.05, parameters.survival_cap);
    float p_death = 1.0 - q;
    if (get_random_numbers(seed).x < p_death) return true;
    throughput /= 1.0 - p_death;
    return false;
}

vec3 trace_branch(ShadingData s, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint path_length = 1u; path_length <= parameters.max_path_length; ++path_length) {
        if (!is_above_surface(s, s.out_direction)) break;

        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length)) radiance += throughput * direct_light;
            bool is_useless = !HAS_BACKGROUND && path_length == parameters.max_path_length;
            if (is_useless) break;
        }

        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) break;
        throughput *= PI * get_brdf(s, omega);
        if (path_length >= parameters.roulette_start && dies(throughput, seed)) break;

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
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);

    vec3 reflected = vec3(0.0);
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch) reflected += trace_branch(s, seed);
    reflected /= float(parameters.splitting_factor);
    return (is_counted(0u) ? s.emission : vec3(0.0)) + reflected;
}
