#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "direct_light.glsl"

bool is_lamp(ShadingData s) { return s.emission.r > 0.0 || s.emission.g > 0.0 || s.emission.b > 0.0; }

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    uint path_length = 0u;
    do {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += throughput * get_background_radiance(ray.direction);
            return radiance;
        }
        ShadingData s = get_shading_data(hit, ray.direction);

        // We have found a light: the path is complete. It only counts if no light sample has counted it before.
        if (is_lamp(s)) {
            bool count_it = path_length == 0u || STRATEGY == STRATEGY_BOUNCES;
            if (count_it && is_counted(path_length)) radiance += throughput * s.emission;
            return radiance;
        }
        if (path_length == parameters.max_path_length) return radiance;
        if (!is_above_surface(s, s.out_direction)) return radiance;

        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length + 1u)) radiance += throughput * direct_light;
            if (!HAS_BACKGROUND && path_length + 1u == parameters.max_path_length) return radiance;
        }

        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) return radiance;
        throughput *= PI * get_brdf(s, omega);
        ray = get_ray_from_surface(s, omega);
        ++path_length;
    } while (true);
    return radiance;
}
