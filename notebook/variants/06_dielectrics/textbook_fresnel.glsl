// Dielectrics with the formulas of the textbooks and GLSL's own reflect() and refract().
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// For unpolarised light: the mean of both polarisations, from the two cosines and the indices on both sides (only their
// ratio matters). r_s = (n₁ c₁ - n₂ c₂) / (n₁ c₁ + n₂ c₂), r_p = (n₂ c₁ - n₁ c₂) / (n₂ c₁ + n₁ c₂).
float fresnel(float c_1, float c_2, float n_1, float n_2) {
    float r_s = (n_1 * c_1 - n_2 * c_2) / (n_1 * c_1 + n_2 * c_2);
    float r_p = (n_2 * c_1 - n_1 * c_2) / (n_2 * c_1 + n_1 * c_2);
    return (r_s * r_s + r_p * r_p) / 2.0;
}

// Direction in which a path continues from glass, and the factor of its radiance.
vec3 scatter_at_glass(ShadingData s, vec3 incident, float u, out float radiance_factor) {
    float n = s.relative_index;
    float c_1 = -dot(s.normal, incident);
    float sin_2 = sqrt(max(1.0 - c_1 * c_1, 0.0)) / n;  // Snell
    radiance_factor = 1.0;
    if (sin_2 >= 1.0) return reflect(incident, s.normal);  // total internal reflection
    float c_2 = sqrt(1.0 - sin_2 * sin_2);
    if (u < fresnel(c_1, c_2, 1.0, n)) return reflect(incident, s.normal);
    // L / n² stays the same along a ray, and the light comes from the side with index n.
    radiance_factor = 1.0 / (n * n);
    return normalize(refract(incident, s.normal, 1.0 / n));
}

vec3 trace_branch(ShadingData s, vec3 incident, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = s.transmittance;
    float scale = 1.0;  // 1/n² of the medium in which the path is; survival does not depend on it
    for (uint k = 1u; k <= parameters.max_path_length; ++k) {
        if (!is_above_surface(s, -incident)) break;
        bool was_sampled = !s.is_dielectric && STRATEGY != STRATEGY_BOUNCES;
        vec3 next;
        if (s.is_dielectric) {
            float factor;
            next = scatter_at_glass(s, incident, get_random_numbers(seed).x, factor);
            // On the same side of the triangle as of the interpolated normal, or it carries nothing.
            if (dot(next, s.normal) * dot(next, s.geometric_normal) <= 0.0) break;
            scale *= factor;
        } else {
            if (STRATEGY != STRATEGY_BOUNCES) {
                vec3 direct_light = sample_direct_light(s, seed);
                if (is_counted(k)) radiance += scale * throughput * direct_light;
                if (!HAS_BACKGROUND && k == parameters.max_path_length) break;
            }
            next = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
            if (!is_above_surface(s, next)) break;
            throughput *= PI * get_brdf(s, next);
        }

        if (k >= parameters.roulette_start) {
            float q = min(max(throughput.r, max(throughput.g, throughput.b)) / parameters.survival_weight, parameters.survival_cap);
            if (get_random_numbers(seed).x >= q) break;
            throughput /= q;
        }

        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, next), NO_LIMIT, hit)) {
            if (is_counted(k)) radiance += scale * throughput * get_background_radiance(next);
            break;
        }
        s = get_shading_data(hit, next);
        incident = next;
        throughput *= s.transmittance;
        if (!was_sampled && is_counted(k)) radiance += scale * throughput * s.emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = vec3(0.0);
    for (uint i = 0u; i < parameters.splitting_factor; ++i) radiance += trace_branch(s, ray.direction, seed);
    radiance /= float(parameters.splitting_factor);
    if (is_counted(0u)) radiance += s.transmittance * s.emission;
    return radiance;
}
