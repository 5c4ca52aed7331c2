// The lobe is chosen with another probability. The loop starts at the first hit, and what a bounce finds is added at the hit that
// it starts from, just like the light sample.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "06_dielectrics/dielectric.glsl"

float get_share_of_the_lobe(ShadingData s) {
#ifdef FEATURE_SPECULAR
    float k_s = dot(s.specular_albedo, vec3(1.0)), k_d = dot(s.diffuse_albedo, vec3(1.0));
    return k_s > 0.0 ? clamp(k_s / (k_s + k_d), 0.1, 0.9) : 0.0;
#else
    return 0.0;
#endif
}

// Density with respect to solid angle of a direction, with the lobe and without it.
float get_density(ShadingData s, vec3 omega, vec3 eye) {
    float of_cosine = dot(s.normal, omega) / PI, of_lobe = 0.0, share = get_share_of_the_lobe(s);
#ifdef FEATURE_SPECULAR
    of_lobe = (s.specular_exponent + 1.0) * get_lobe(s, omega) / (2.0 * PI);
#endif
    return (1.0 - share) * of_cosine + share * of_lobe;
}

vec3 choose_direction(ShadingData s, vec3 eye, inout uvec2 seed) {
#ifdef FEATURE_SPECULAR
    if (happens(get_share_of_the_lobe(s), seed)) {
        // By the square t of tan(α/2), for which cos α = (1 - t) / (1 + t).
        vec2 u = get_random_numbers(seed);
        float x = -0.5 * log(1.0 - u.y) / (s.specular_exponent + 1.0);
        float t = x < 0.01 ? x * (1.0 - x * x / 3.0) : tanh(x);
        float phi = 2.0 * PI * u.x;
        vec3 about_z = vec3(2.0 * sqrt(t) * vec2(cos(phi), sin(phi)), 1.0 - t) / (1.0 + t);
        return get_shading_space(2.0 * dot(eye, s.normal) * s.normal - eye) * about_z;
    }
#endif
    return get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
}

// What a light sample contributes at a hit: ρ cos θ L_e / (p_l + p_b).
vec3 sample_lights(ShadingData s, vec3 eye, inout uvec2 seed) {
    LightTriangle light = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    if (u.x + u.y > 1.0) u = 1.0 - u;
    LightPoint y = get_light_point(light, u);
    float r = distance(y.position, s.position);
    vec3 omega = (y.position - s.position) / r;
    if (!is_above_surface(s, omega) || !(dot(omega, y.normal) < 0.0)) return vec3(0.0);
    float geometry = -dot(omega, y.normal) / (r * r);
    float p_bounce = STRATEGY != STRATEGY_LIGHT ? get_density(s, omega, eye) : 0.0;
    vec3 f = get_brdf(s, omega) * dot(s.normal, omega) * y.emission;
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);
    return f * geometry / (1.0 / light.inverse_density + geometry * p_bounce);
}

// Weight of light found by a bounce of this density: 1 / (1 + p_l / p_b).
float get_share_of_the_bounce(ShadingData at_light, float r, vec3 omega, float p_bounce) {
    if (at_light.light_density == 0.0) return 1.0;
    if (p_bounce == 0.0) return 0.0;
    float geometry = -dot(omega, at_light.geometric_normal) / (r * r);
    return 1.0 / (1.0 + at_light.light_density / (geometry * p_bounce));
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 throughput = s.transmittance, eye = -ray.direction;
    vec3 radiance = is_counted(0u) ? throughput * s.emission : vec3(0.0);
    float scale = 1.0;  // 1/η² for each medium entered
    for (uint k = 1u; k <= parameters.max_path_length; ++k) {
        if (!is_above_surface(s, eye)) break;
        bool is_smooth = s.is_dielectric, has_sample = STRATEGY != STRATEGY_BOUNCES && !is_smooth;
        if (has_sample && is_counted(k)) radiance += scale * throughput * sample_lights(s, eye, seed);

        vec3 omega;
        float p_bounce = 0.0;
        if (is_smooth) {
            BsdfSample at_glass = sample_dielectric(s, seed);
            if (at_glass.weight == vec3(0.0)) break;
            omega = at_glass.direction;
            scale *= at_glass.radiance_scale;
        } else {
            omega = choose_direction(s, eye, seed);
            if (!is_above_surface(s, omega)) break;
            p_bounce = get_density(s, omega, eye);
            throughput *= get_brdf(s, omega) * dot(s.normal, omega) / p_bounce;
        }
        if (k >= parameters.roulette_start) {
            float q = min(max_component(throughput) / parameters.survival_weight, parameters.survival_cap);
            if (!happens(q, seed)) break;
            throughput /= q;
        }
        ray = get_ray_from_surface(s, omega);
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(k)) radiance += scale * throughput * get_background_radiance(omega);
            break;
        }
        s = get_shading_data(hit, omega);
        eye = -omega;
        throughput *= s.transmittance;
        float weight = has_sample ? get_share_of_the_bounce(s, hit.distance, omega, STRATEGY != STRATEGY_LIGHT ? p_bounce : 0.0) : 1.0;
        if (is_counted(k)) radiance += scale * weight * throughput * s.emission;
    }
    return radiance;
}
