// Splitting in a single loop: whenever a branch ends, the next one starts at the first hit, until none is left.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

struct Branch {
    ShadingData s;
    vec3 out_direction;
    vec3 throughput;
    uint k;  // x_k is where the branch is
};

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    bool is_hit = trace_ray(ray, NO_LIMIT, hit);
    if (!is_hit) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData first = get_shading_data(hit, ray.direction);
    vec3 emitted = is_counted(0u) ? first.emission : vec3(0.0);
    vec3 eye = -ray.direction;
    if (parameters.max_path_length == 0u || !is_above_surface(first, eye)) return emitted;

    // Every branch starts with its share of the path's weight, and needs no other factor later on.
    Branch start = Branch(first, eye, vec3(1.0) / float(parameters.splitting_factor), 1u);
    Branch branch = start;
    uint branches_left = parameters.splitting_factor;
    vec3 reflected = vec3(0.0);
    while (branches_left > 0u) {
        ShadingData s = branch.s;
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(branch.k)) reflected += branch.throughput * direct_light;
        }
        // Each step below must be possible for the branch to reach another hit.
        bool is_at_end = STRATEGY != STRATEGY_BOUNCES && !HAS_BACKGROUND && branch.k == parameters.max_path_length;
        bool goes_on = !is_at_end;
        vec3 omega;
        if (goes_on) {
            omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
            goes_on = is_above_surface(s, omega);
        }
        if (goes_on) {
            branch.throughput *= PI * get_brdf(s, omega);
            goes_on = trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit);
            if (!goes_on && is_counted(branch.k)) reflected += branch.throughput * get_background_radiance(omega);
        }
        if (goes_on) {
            branch.s = get_shading_data(hit, omega);
            branch.out_direction = -omega;
            if (STRATEGY == STRATEGY_BOUNCES && is_counted(branch.k)) reflected += branch.throughput * branch.s.emission;
            ++branch.k;
            goes_on = branch.k <= parameters.max_path_length && is_above_surface(branch.s, branch.out_direction);
        }
        if (!goes_on) {
            --branches_left;
            branch = start;
        }
    }
    return emitted + reflected;
}
