// Splitting with stratified branches. The first bounce of branch i takes its azimuth from the i-th of s equal slices, so the branches
// spread around the normal. Each branch on its own would not be uniform any more, but their mean is unbiased.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

vec3 follow(ShadingData s, float slice_begin, float slice_width, inout uvec2 seed) {
    vec3 found = vec3(0.0);
    vec3 weight = vec3(1.0);
    bool nee = STRATEGY != STRATEGY_BOUNCES;
    uint bounces = 1u;
    while (bounces <= parameters.max_path_length && is_above_surface(s, s.out_direction)) {
        if (nee) {
            vec3 l = sample_direct_light(s, seed);
            if (is_counted(bounces)) found += weight * l;
            if (!HAS_BACKGROUND && bounces == parameters.max_path_length) break;
        }

        vec2 u = get_random_numbers(seed);
        if (bounces == 1u) u.x = slice_begin + slice_width * u.x;
        vec3 dir = get_shading_space(s.normal) * sample_hemisphere(u);
        if (!is_above_surface(s, dir)) break;
        weight *= PI * get_brdf(s, dir);

        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, dir), NO_LIMIT, hit)) {
            if (is_counted(bounces)) found += weight * get_background_radiance(dir);
            break;
        }
        s = get_shading_data(hit, dir);
        if (!nee && is_counted(bounces)) found += weight * s.emission;
        ++bounces;
    }
    return found;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);

    uint count = parameters.splitting_factor;
    float width = 1.0 / float(count);
    vec3 total = vec3(0.0);
    for (uint i = 0u; i < count; ++i) total += follow(s, float(i) * width, width, seed);

    vec3 emitted = is_counted(0u) ? s.emission : vec3(0.0);
    return emitted + total / float(count);
}
