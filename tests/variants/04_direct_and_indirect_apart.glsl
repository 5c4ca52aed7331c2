// Splitting in two loops: first s light samples at the first hit, then s bounces from there. Each is averaged for
// itself: the expectation of a sum is the sum of the expectations, whichever numbers they share.
#include "sampling.glsl"
#include "direct_light.glsl"

// Next vertex of a path, or the end of it.
struct Step {
    bool is_hit;
    ShadingData s;
    vec3 direction;
    vec3 factor;  // π ρ, or 0 if there was no direction
};

Step take_step(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    Step step;
    step.is_hit = false;
    step.factor = vec3(0.0);
    step.direction = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
    if (!is_above_surface(s, step.direction)) return step;
    step.factor = get_pi_brdf(s, step.direction, out_direction);
    Hit hit;
    step.is_hit = trace_ray(get_ray_from_surface(s, step.direction), NO_LIMIT, hit);
    if (step.is_hit) step.s = get_shading_data(hit, step.direction);
    return step;
}

// All light that reaches s after a first bounce into a random direction.
vec3 trace_indirect(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    uint bounces = 1u;
    while (true) {
        // A last ray finds nothing but the sky where lights are sampled.
        if (LIGHT_SAMPLING && !HAS_BACKGROUND && bounces == parameters.max_path_length) return radiance;
        Step step = take_step(s, out_direction, seed);
        throughput *= step.factor;
        if (!step.is_hit) {
            if (is_counted(bounces)) radiance += throughput * get_background_radiance(step.direction);
            return radiance;
        }
        s = step.s;
        out_direction = -step.direction;
        if (!LIGHT_SAMPLING && is_counted(bounces)) radiance += throughput * s.emission;
        if (++bounces > parameters.max_path_length || !is_above_surface(s, out_direction)) return radiance;
        if (!LIGHT_SAMPLING) continue;
        vec3 direct_light = sample_direct_light(s, out_direction, seed);
        if (is_counted(bounces)) radiance += throughput * direct_light;
    }
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.emission : vec3(0.0);
    vec3 out_direction = -ray.direction;
    if (parameters.max_path_length == 0u || !is_above_surface(s, out_direction)) return radiance;

    float share = 1.0 / float(parameters.splitting_factor);
    if (LIGHT_SAMPLING) {
        vec3 direct = vec3(0.0);
        for (uint i = 0u; i < parameters.splitting_factor; ++i) direct += sample_direct_light(s, out_direction, seed);
        if (is_counted(1u)) radiance += share * direct;
    }
    vec3 indirect = vec3(0.0);
    for (uint i = 0u; i < parameters.splitting_factor; ++i) indirect += trace_indirect(s, out_direction, seed);
    return radiance + share * indirect;
}
