#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// Advances s to the next hit. Returns false where there is none; then `radiance` has got the background.
bool next_hit(inout ShadingData s, inout vec3 throughput, inout vec3 radiance, uint path_length, inout uvec2 seed) {
    vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
    if (!is_above_surface(s, omega)) return false;
    throughput *= PI * get_brdf(s, omega);
    Hit hit;
    if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
        if (is_counted(path_length)) radiance += throughput * get_background_radiance(omega);
        return false;
    }
    s = get_shading_data(hit, omega);
    return true;
}

// The light that one branch brings to the camera.
vec3 trace_branch(inout ShadingData s, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint path_length = 1u; path_length <= parameters.max_path_length; ++path_length) {
        if (!is_above_surface(s, s.out_direction)) break;
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length)) radiance += throughput * direct_light;
            // nothing that the last ray could find
            if (!HAS_BACKGROUND && path_length == parameters.max_path_length) break;
        }
        if (!next_hit(s, throughput, radiance, path_length, seed)) break;
        if (STRATEGY == STRATEGY_BOUNCES && is_counted(path_length)) radiance += throughput * s.emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.emission : vec3(0.0);

    vec3 reflected = vec3(0.0);
    for (uint i = 0u; i < parameters.splitting_factor; i++) reflected += trace_branch(s, seed);
    return radiance + reflected / float(parameters.splitting_factor);
}
