// Chapter 6, dielectrics: at smooth glass and water light is either reflected or refracted, each into a single
// direction.
//
// A fraction F of the light is reflected (Fresnel), 1 - F refracted. The estimator follows one of the two directions,
// chosen with these probabilities, so that the weight is 1. No light sample can meet exactly that direction, so after such
// a bounce emission counts where the path finds it. The resulting bright caustics are found by chance only, and stay
// noisy.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"
#include "dielectric.glsl"
#include "sample_bsdf.glsl"

// Estimates the light that the first hit x_1 scatters to the camera, by one path.
vec3 trace_branch(ShadingData s, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = s.transmittance;
    // Where light enters a medium its solid angle shrinks and its radiance grows by η². This factor stays apart from the
    // throughput: what has entered glass will leave it again, and should be no less likely to survive.
    float radiance_scale = 1.0;
    for (uint path_length = 1u; path_length <= parameters.max_path_length; ++path_length) {
        // At x_k with k = path_length: the direct light, which arrives after k bounces. Glass blocks shadow rays: they
        // would have to bend.
        if (!is_above_surface(s, s.out_direction)) break;
        bool is_light_sampled = STRATEGY != STRATEGY_BOUNCES && !s.is_dielectric;
        if (is_light_sampled) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length)) radiance += radiance_scale * throughput * direct_light;
        }
        // The last ray could only find the background, or lights that have been sampled.
        if (is_light_sampled && !HAS_BACKGROUND && path_length == parameters.max_path_length) break;

        // Sample ω_k.
        BsdfSample bounce = sample_bsdf(s, seed);
        if (bounce.weight == vec3(0.0)) break;
        throughput *= bounce.weight;
        radiance_scale *= bounce.radiance_scale;

        // Russian roulette with the survival probability q = min(max throughput / β_s, cap), without the split's 1/s.
        if (path_length >= parameters.roulette_start) {
            float survival_probability =
                min(max_component(throughput) / parameters.survival_weight, parameters.survival_cap);
            if (!happens(survival_probability, seed)) break;
            throughput /= survival_probability;
        }

        // Trace the ray x_k, ω_k to the next hit. If it misses all triangles, it sees the background.
        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, bounce.direction), NO_LIMIT, hit)) {
            if (is_counted(path_length))
                radiance += radiance_scale * throughput * get_background_radiance(bounce.direction);
            break;
        }
        s = get_shading_data(hit, bounce.direction);
        throughput *= s.transmittance;
        is_light_sampled = STRATEGY != STRATEGY_BOUNCES && !s.is_dielectric;
        if (!is_light_sampled && is_counted(path_length)) radiance += radiance_scale * throughput * s.emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    // The camera ray is traced once.
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.transmittance * s.emission : vec3(0.0);

    // Split: all branches start at x_1. The generator's state runs on, so their random numbers differ.
    float branch_weight = 1.0 / float(parameters.splitting_factor);
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch)
        radiance += branch_weight * trace_branch(s, seed);
    return radiance;
}
