// Chapter 3, next event estimation.
// Light arrives at a surface in two ways: directly from a light (sampled below) or from other surfaces (the bounce).
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "direct_light.glsl"

vec3 path_trace(Ray ray, inout uvec2 seed) {
    const bool samples_lights = STRATEGY != STRATEGY_BOUNCES;
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint path_length = 0u;; ++path_length) {
        // What shines by itself is seen by the camera; all later emission is direct light, which has been sampled.
        bool counts_emission = (path_length == 0u || !samples_lights) && is_counted(path_length);

        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (counts_emission) radiance += throughput * get_background_radiance(ray.direction);
            break;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (counts_emission) radiance += throughput * s.emission;
        if (path_length == parameters.max_path_length || !is_above_surface(s, s.out_direction)) break;

        // Direct light
        if (samples_lights) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length + 1u)) radiance += throughput * direct_light;
        }

        // Indirect light
        vec2 u = get_random_numbers(seed);
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(u);
        if (!is_above_surface(s, omega)) break;
        throughput *= PI * get_brdf(s, omega);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
