#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// Adds to `sum` what one branch finds. The share of the branch is part of its throughput from the start.
void add_branch(ShadingData s, vec3 throughput, inout vec3 sum, inout uvec2 seed) {
    const bool samples_lights = STRATEGY != STRATEGY_BOUNCES;
    uint bounces_left = parameters.max_path_length;
    while (bounces_left > 0u && is_above_surface(s, s.out_direction)) {
        bool counts = is_counted(parameters.max_path_length - bounces_left + 1u);
        --bounces_left;

        // The direction comes first, then the point on the light.
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (samples_lights) {
            vec3 direct = sample_direct_light(s, seed);
            sum += counts ? throughput * direct : vec3(0.0);
            if (bounces_left == 0u && !HAS_BACKGROUND) return;
        }
        if (!is_above_surface(s, omega)) return;
        throughput *= get_brdf(s, omega) * PI;

        Hit hit;
        bool is_hit = trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit);
        vec3 light = vec3(0.0);
        if (is_hit) {
            s = get_shading_data(hit, omega);
            if (!samples_lights) light = s.emission;
        } else {
            light = get_background_radiance(omega);
        }
        if (counts) sum += throughput * light;
        if (!is_hit) return;
    }
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 sum = vec3(0.0);
    Hit hit;
    if (trace_ray(ray, NO_LIMIT, hit)) {
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(0u)) sum = s.emission;
        vec3 share = vec3(1.0 / float(parameters.splitting_factor));
        for (uint left = parameters.splitting_factor; left > 0u; --left) add_branch(s, share, sum, seed);
    } else if (is_counted(0u)) {
        sum = get_background_radiance(ray.direction);
    }
    return sum;
}
