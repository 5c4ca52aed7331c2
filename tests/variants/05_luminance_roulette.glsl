// Russian roulette by what the eye would miss: the survival probability is the luminance of the throughput. Any
// probability that depends on the path so far and is above 0 wherever the throughput is not keeps the expectation.
#include "sampling.glsl"
#include "direct_light.glsl"

// Rec. 709 weights; at least half of the largest channel, so that red and blue light does not become noisy.
float get_importance(vec3 throughput) {
    float luminance = dot(throughput, vec3(0.2126, 0.7152, 0.0722));
    return max(luminance, 0.5 * max_component(throughput));
}

// Whether the path goes on; if so, it counts for those that do not.
bool survives(inout vec3 throughput, inout uvec2 seed) {
    float q = min(get_importance(throughput), parameters.survival_cap);
    bool is_dead = get_random_numbers(seed).y >= q;
    if (is_dead) return false;
    throughput /= q;
    return true;
}

vec3 get_path_radiance(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    uint k = 0u;
    while (k++ < parameters.max_path_length) {
        if (!is_above_surface(s, out_direction)) break;
        vec3 direct_light = vec3(0.0);
        if (LIGHT_SAMPLING) direct_light = sample_direct_light(s, out_direction, seed);
        if (is_counted(k)) radiance += throughput * direct_light;
        // Another ray serves the sky, emission without light samples, or another bounce.
        bool has_use = HAS_BACKGROUND || !LIGHT_SAMPLING || k < parameters.max_path_length;
        if (!has_use) break;

        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) break;
        throughput *= get_pi_brdf(s, omega, out_direction);
        if (k >= parameters.roulette_start && !survives(throughput, seed)) break;

        Hit hit;
        bool is_hit = trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit);
        vec3 found;
        if (is_hit) {
            s = get_shading_data(hit, omega);
            out_direction = -omega;
            found = LIGHT_SAMPLING ? vec3(0.0) : s.emission;
        } else {
            found = get_background_radiance(omega);
        }
        if (is_counted(k)) radiance += throughput * found;
        if (!is_hit) break;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 scattered = vec3(0.0);
    uint branch_count = parameters.splitting_factor;
    for (uint i = 0u; i < branch_count; ++i) scattered += get_path_radiance(s, -ray.direction, seed);
    scattered /= float(branch_count);
    if (is_counted(0u)) scattered += s.emission;
    return scattered;
}
