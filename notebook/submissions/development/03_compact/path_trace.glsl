#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "direct_light.glsl"

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 L = vec3(0.0), T = vec3(1.0);
    bool direct = STRATEGY != STRATEGY_BOUNCES;
    for (uint k = 0u; k <= parameters.max_path_length; ++k) {
        // Lights are sampled from the second vertex on, so light that we run into counts for the camera ray only.
        bool show_lights = k == 0u || !direct;
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (show_lights && is_counted(k)) L += T * get_background_radiance(ray.direction);
            break;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (show_lights && is_counted(k)) L += T * s.emission;
        if (k == parameters.max_path_length || !is_above_surface(s, s.out_direction)) break;
        if (direct) {
            vec3 D = sample_direct_light(s, seed);
            if (is_counted(k + 1u)) L += T * D;
        }
        vec3 w = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, w)) break;
        T *= PI * get_brdf(s, w);
        ray = get_ray_from_surface(s, w);
    }
    return L;
}
