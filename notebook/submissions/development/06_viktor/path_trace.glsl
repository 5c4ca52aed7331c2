#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"
#include "dielectric.glsl"
#include "sample_bsdf.glsl"

// One path from the first hit on.
vec3 trace_branch(ShadingData s, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = s.transmittance;
    float eta_scale = 1.0;
    bool sees_lights = STRATEGY == STRATEGY_BOUNCES;  // whether emission at the next hit is new
    for (uint path_length = 1u; path_length <= parameters.max_path_length; ++path_length) {
        if (!is_above_surface(s, s.out_direction)) break;

        if (s.is_dielectric) {
            // No light sample can meet the single direction.
            sees_lights = true;
        } else if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length)) radiance += eta_scale * throughput * direct_light;
        }
        if (!sees_lights && !HAS_BACKGROUND && path_length == parameters.max_path_length) break;

        BsdfSample b = sample_bsdf(s, seed);
        if (b.weight == vec3(0.0)) break;
        throughput *= b.weight;
        eta_scale *= b.radiance_scale;

        if (path_length >= parameters.roulette_start) {
            float q = min(parameters.survival_cap, max_component(throughput) / parameters.survival_weight);
            if (!happens(q, seed)) break;
            throughput /= q;
        }

        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, b.direction), NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += eta_scale * throughput * get_background_radiance(b.direction);
            break;
        }
        s = get_shading_data(hit, b.direction);
        throughput *= s.transmittance;
        if (sees_lights && is_counted(path_length)) radiance += eta_scale * throughput * s.emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.transmittance * s.emission : vec3(0.0);
    vec3 mean = vec3(0.0);
    for (uint i = 0u; i < parameters.splitting_factor; ++i) mean += trace_branch(s, seed);
    return radiance + mean / float(parameters.splitting_factor);
}
