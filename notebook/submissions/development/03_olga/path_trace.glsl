// Chapter 3, Olga's version: the loop ends with the light of both kinds, so that everything about light stands in one place.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "direct_light.glsl"

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 path_weight = vec3(1.0);
    for (uint path_length = 0u;; ++path_length) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += path_weight * get_background_radiance(ray.direction);
            return radiance;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        bool is_last = path_length == parameters.max_path_length;

        // Where does the path go on?
        vec3 before = path_weight;
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        path_weight *= PI * get_brdf(s, omega);

        // Emitted light: only the camera sees it, later hits have had their light sample.
        if (STRATEGY == STRATEGY_BOUNCES || path_length == 0u) {
            if (is_counted(path_length)) radiance += before * s.emission;
        }
        if (is_last || !is_above_surface(s, s.out_direction)) return radiance;

        // Direct light, one bounce later
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 light = sample_direct_light(s, seed);
            if (is_counted(path_length + 1u)) radiance += path_weight * light;
        }

        if (!is_above_surface(s, omega)) return radiance;
        ray = get_ray_from_surface(s, omega);
    }
}
