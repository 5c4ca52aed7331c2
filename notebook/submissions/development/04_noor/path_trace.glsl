// Exercise 4. One camera ray, then `n` paths from where it arrives. The result is the average.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

vec3 trace_branch(ShadingData s, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint path_length = 1u; path_length <= parameters.max_path_length; ++path_length) {
        if (!is_above_surface(s, s.out_direction)) break;
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length)) radiance += throughput * direct_light;
        }
        if (STRATEGY != STRATEGY_BOUNCES && !HAS_BACKGROUND && path_length == parameters.max_path_length) break;

        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) break;
        throughput *= PI * get_brdf(s, omega);

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
    uint n = parameters.splitting_factor;
    vec3 sum = vec3(0.0);
    Hit hit;
    if (trace_ray(ray, NO_LIMIT, hit)) {
        ShadingData s = get_shading_data(hit, ray.direction);
        // what the camera sees directly
        if (is_counted(0u)) sum = s.emission;
        // what is reflected
        for (uint k = 0u; k < n; ++k)
            sum += trace_branch(s, seed);
    } else if (is_counted(0u)) {
        sum = float(n) * get_background_radiance(ray.direction);
    }
    return sum / float(n);
}
