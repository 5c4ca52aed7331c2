// Dielectrics with a split without chance at the first hit: if the camera sees glass, the branches share reflection and
// refraction as F and 1 - F ask for it. Branch b takes the number (b + u) / s with one u for all branches: each of
// these numbers is uniform in strata, so the mean over the branches keeps its expectation.
#include "sampling.glsl"
#include "direct_light.glsl"

// Reflectance by the half sum and half difference of the angles, for unpolarised light.
float get_fresnel(float theta_i, float theta_t) {
    float difference = theta_i - theta_t, sum = theta_i + theta_t;
    float s = sin(difference) / sin(sum);
    float p = tan(difference) / tan(sum);
    return 0.5 * (s * s + p * p);
}

vec3 choose_at_glass(ShadingData s, vec3 out_direction, float u) {
    float cos_i = min(dot(s.normal, out_direction), 1.0);
    vec3 along = out_direction - cos_i * s.normal;  // tangential part, of length sin θ_i
    float sin_i = length(along);
    float sin_t = sin_i / s.relative_index;
    vec3 mirrored = cos_i * s.normal - along;
    if (sin_t >= 1.0) return mirrored;
    // At perpendicular incidence the formulas are 0/0; their limit is ((η - 1) / (η + 1))².
    float root = (s.relative_index - 1.0) / (s.relative_index + 1.0);
    float reflected = sin_i < 1e-3 ? root * root : get_fresnel(atan(sin_i, cos_i), asin(sin_t));
    if (u < reflected) return mirrored;
    return normalize(-sqrt(1.0 - sin_t * sin_t) * s.normal - along / s.relative_index);
}

// `first_number` chooses at the first hit if that is glass.
vec3 trace_branch(ShadingData s, vec3 out_direction, float first_number, inout uvec2 seed) {
    vec3 sum = vec3(0.0);
    vec3 throughput = s.transmittance;
    float index = 1.0;  // of the medium in which the path is, over that of the camera
    for (uint k = 1u; k <= parameters.max_path_length; ++k) {
        if (!is_above_surface(s, out_direction)) break;
        bool is_glass = s.is_dielectric;
        if (!is_glass && LIGHT_SAMPLING) {
            vec3 direct_light = sample_direct_light(s, out_direction, seed);
            if (is_counted(k)) sum += throughput * direct_light / (index * index);
        }
        bool must_find_emission = is_glass || !LIGHT_SAMPLING;
        if (k == parameters.max_path_length && !must_find_emission && !HAS_BACKGROUND) break;

        vec2 u = get_random_numbers(seed);
        vec3 omega;
        if (!is_glass) {
            omega = get_shading_space(s.normal) * sample_hemisphere(u);
            if (!is_above_surface(s, omega)) break;
            throughput *= get_pi_brdf(s, omega, out_direction);
        } else {
            omega = choose_at_glass(s, out_direction, k == 1u ? first_number : u.x);
            bool is_beyond = dot(omega, s.normal) < 0.0;
            bool is_beyond_triangle = dot(omega, s.geometric_normal) < 0.0;
            if (is_beyond != is_beyond_triangle) break;
            if (is_beyond) index *= s.relative_index;
        }

        if (k >= parameters.roulette_start) {
            float survival_probability = min(max_component(throughput), parameters.survival_cap);
            bool survives = get_random_numbers(seed).y < survival_probability;
            if (!survives) break;
            throughput /= survival_probability;
        }
        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            // L / index² is what stays the same across surfaces.
            if (is_counted(k)) sum += throughput * get_background_radiance(omega) / (index * index);
            break;
        }
        s = get_shading_data(hit, omega);
        out_direction = -omega;
        throughput *= s.transmittance;
        if (must_find_emission && is_counted(k)) sum += throughput * s.emission / (index * index);
    }
    return sum;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = vec3(0.0);
    float count = float(parameters.splitting_factor);
    float shared_number = get_random_numbers(seed).x;
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch) {
        float first_number = (float(branch) + shared_number) / count;
        radiance += trace_branch(s, -ray.direction, first_number, seed) / count;
    }
    if (is_counted(0u)) radiance += s.transmittance * s.emission;
    return radiance;
}
