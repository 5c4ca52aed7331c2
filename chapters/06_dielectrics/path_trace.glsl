// Chapter 6, dielectrics: at smooth glass and water light is either reflected or refracted, each into a single
// direction.
//
// A share F of the light is reflected (Fresnel), 1 - F refracted. The estimator follows one of the two directions,
// chosen with these probabilities, so that the weight is 1. No light sample can meet exactly that direction: after
// such a bounce emission counts where the path finds it. The bright caustics that arise are found by chance only, so
// they are noisy.
#include "sampling.glsl"
#include "direct_light.glsl"

// The Fresnel reflectance for unpolarised light. cos θ > 0 belongs to the incident direction, η is the refractive index
// beyond the surface over that before it, η cos θ_t belongs to the refracted direction, with Snell's law
// (η cos θ_t)² = η² - 1 + cos² θ. Both numerators hold η² - 1 as a factor: nothing cancels where η is close to 1.
float get_fresnel_reflectance(float cos_theta, float eta, float eta_cos_theta_t) {
    float contrast = (eta - 1.0) * (eta + 1.0);
    if (contrast == 0.0) return 0.0;
    float sum_s = cos_theta + eta_cos_theta_t;
    float sum_p = eta * eta * cos_theta + eta_cos_theta_t;
    float r_s = -contrast / (sum_s * sum_s);
    float r_p = contrast * ((eta * eta + 1.0) * cos_theta * cos_theta - 1.0) / (sum_p * sum_p);
    return 0.5 * (r_s * r_s + r_p * r_p);
}

// The direction ω_k behind or before a smooth dielectric, reflected with probability F.
vec3 sample_dielectric(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    float cos_theta = dot(s.normal, out_direction);
    float eta = s.relative_index;
    float contrast = (eta - 1.0) * (eta + 1.0);
    float square = contrast + cos_theta * cos_theta;
    // Without a refracted direction all light is reflected: total internal reflection.
    float eta_cos_theta_t = sqrt(max(square, 0.0));
    if (square <= 0.0 || happens(get_fresnel_reflectance(cos_theta, eta, eta_cos_theta_t), seed))
        return 2.0 * cos_theta * s.normal - out_direction;
    // cos θ - η cos θ_t, once more without cancellation.
    float difference = -contrast / (cos_theta + eta_cos_theta_t);
    return normalize(difference * s.normal - out_direction);
}

// The light that arrives at the first hit x_1 and that it scatters to the camera, by one path with random numbers of
// its own.
vec3 trace_branch(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = s.transmittance;
    // Radiance grows by η² where it enters a medium, since its solid angle shrinks. This factor is kept apart from the
    // throughput: what has entered glass will leave it again and is no less likely to survive.
    float radiance_scale = 1.0;
    for (uint path_length = 1u; path_length <= parameters.max_path_length; ++path_length) {
        // At x_k with k = path_length: the direct light, which arrives after k bounces. Glass blocks shadow rays: they
        // would have to bend.
        if (!is_above_surface(s, out_direction)) break;
        bool is_light_sampled = LIGHT_SAMPLING && !s.is_dielectric;
        if (is_light_sampled) {
            vec3 direct_light = sample_direct_light(s, out_direction, seed);
            if (is_counted(path_length)) radiance += radiance_scale * throughput * direct_light;
        }
        // The last ray could only find lights that have been sampled, or the background.
        if (is_light_sampled && !HAS_BACKGROUND && path_length == parameters.max_path_length) break;

        // Sample ω_k: at a dielectric one of two directions, elsewhere with density n·ω_k / π with respect to solid
        // angle and the weight π ρ. A direction on opposite sides of the two normals carries nothing.
        vec3 omega;
        if (s.is_dielectric) {
            omega = sample_dielectric(s, out_direction, seed);
            bool is_refracted = dot(s.normal, omega) < 0.0;
            if (is_refracted != (dot(s.geometric_normal, omega) < 0.0)) break;
            if (is_refracted) radiance_scale /= s.relative_index * s.relative_index;
        } else {
            omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
            if (!is_above_surface(s, omega)) break;
            throughput *= get_pi_brdf(s, omega, out_direction);
        }

        // Russian roulette with the survival probability q = min(max throughput / β_s, cap). The split's 1/s plays no part.
        if (path_length >= parameters.roulette_start) {
            float survival_probability =
                min(max_component(throughput) / parameters.survival_weight, parameters.survival_cap);
            if (!happens(survival_probability, seed)) break;
            throughput /= survival_probability;
        }

        // Trace the ray x_k, ω_k to the next hit. If it misses all triangles, it sees the background.
        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            if (is_counted(path_length))
                radiance += radiance_scale * throughput * get_background_radiance(omega);
            break;
        }
        s = get_shading_data(hit, omega);
        out_direction = -omega;
        throughput *= s.transmittance;
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

    // Split: all branches start at x_1, and `seed` runs on so that none repeats another's random numbers.
    float branch_weight = 1.0 / float(parameters.splitting_factor);
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch)
        radiance += branch_weight * trace_branch(s, -ray.direction, seed);
    return radiance;
}
