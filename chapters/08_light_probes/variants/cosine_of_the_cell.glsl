// Cells are found and sampled by cos θ itself, and the light of the probe has the power heuristic: each weight is a
// quotient of squares.
#include "multiple_importance_sampling.glsl"

// Row and column of a direction on the probe, and its density.
uint find_cell(vec3 direction) {
    uvec2 count = get_probe_cell_count();
    float turns = (atan(direction.x, -direction.z) + parameters.probe_rotation) / (2.0 * PI) + 0.5;
    float row = float(count.y) * acos(clamp(direction.y, -1.0, 1.0)) / PI;
    uint column = uint(float(count.x) * (turns - floor(turns)));
    return min(uint(row), count.y - 1u) * count.x + min(column, count.x - 1u);
}

float get_share(float own, float other) {
    return own * own / (own * own + other * other);
}

// Light of the probe by one light sample, weighted against a bounce.
vec3 sample_sky(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    uvec2 count = get_probe_cell_count();
    uint chosen = choose_probe_cell(seed);
    float made_with = get_probe_cell_density(chosen);
    vec2 u = get_random_numbers(seed);
    float row_height = PI / float(count.y), upper = float(chosen / count.x) * row_height;
    float z = cos(upper) + u.x * (cos(upper + row_height) - cos(upper));
    float phi = 2.0 * PI * (float(chosen % count.x) + u.y) / float(count.x) - PI - parameters.probe_rotation;
    float across = sqrt(max(0.0, 1.0 - z * z));
    vec3 toward = vec3(across * sin(phi), z, -across * cos(phi));
    if (!is_above_surface(s, toward) || is_occluded(get_ray_from_surface(s, toward), NO_LIMIT)) return vec3(0.0);
    float own = get_probe_cell_density(find_cell(toward));
    float other = BOUNCES_FIND_LIGHTS ? get_brdf_density(s, toward, out_direction) : 0.0;
    float share = own > 0.0 ? get_share(own, other) : 0.0;
    return share * get_background_radiance(toward) * get_pi_brdf(s, toward, out_direction) * dot(s.normal, toward) / PI / made_with;
}

vec3 sample_direct_light(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    bool is_from_probe = LIGHT_PROBE_SAMPLING && (!LIGHT_SAMPLING || happens(LIGHT_PROBE_PROBABILITY, seed));
    return is_from_probe ? sample_sky(s, out_direction, seed) : sample_light_triangle(s, out_direction, seed);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    float radiance_scale = 1.0;     // 1/η² for every medium entered, see chapter 6
    bool is_light_sampled = false;  // whether x_{k-1} has a light sample, too
    float bounce_density = 0.0;     // p_b of the ray's direction, where it has
    for (uint path_length = 0u;; ++path_length) {  // path_length is the slides' k-1
        // Trace the ray x_{k-1}, ω_{k-1}. If it misses all triangles, it sees the background.
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            bool is_shared = LIGHT_PROBE_SAMPLING && is_light_sampled;
            float other = is_shared ? get_probe_cell_density(find_cell(ray.direction)) : 0.0;
            float share = other > 0.0 ? get_share(bounce_density, other) : 1.0;
            if (is_counted(path_length)) radiance += radiance_scale * throughput * share * get_background_radiance(ray.direction);
            break;
        }

        // The emitted radiance L_{e,k}, or the part of it that x_{k-1}'s light sample leaves to this bounce.
        ShadingData s = get_shading_data(hit, ray.direction);
        vec3 out_direction = -ray.direction;
        throughput *= s.transmittance;
        float cos_light = dot(s.geometric_normal, out_direction);
        float light_density = is_light_sampled ? to_solid_angle(s.light_density, hit.distance, cos_light) : 0.0;
        if (is_counted(path_length))
            radiance += radiance_scale * throughput * get_bounce_part(light_density, bounce_density) * s.emission;
        if (path_length == parameters.max_path_length || !is_above_surface(s, out_direction)) break;

        // The direct light at x_k arrives after one bounce more. No light sample meets a dielectric's directions.
        is_light_sampled = (LIGHT_SAMPLING || LIGHT_PROBE_SAMPLING) && !s.is_dielectric;
        if (is_light_sampled) {
            vec3 direct_light = sample_direct_light(s, out_direction, seed);
            if (is_counted(path_length + 1u)) radiance += radiance_scale * throughput * direct_light;
        }

        // Sample ω_k: at a dielectric one of two directions, elsewhere with density p_b.
        vec3 omega;
        if (s.is_dielectric) {
            omega = sample_dielectric(s, out_direction, seed);
            bool is_refracted = dot(s.normal, omega) < 0.0;
            if (is_refracted != (dot(s.geometric_normal, omega) < 0.0)) break;
            if (is_refracted) radiance_scale /= s.relative_index * s.relative_index;
        } else {
            omega = sample_brdf(s, out_direction, seed);
            if (!is_above_surface(s, omega)) break;
            // The weight ρ n·ω / p_b: exactly the albedo of a Lambertian surface.
            float density = get_brdf_density(s, omega, out_direction);
            throughput *= get_pi_brdf(s, omega, out_direction) * (dot(s.normal, omega) / PI / density);
            bounce_density = BOUNCES_FIND_LIGHTS ? density : 0.0;
        }

        // Russian roulette with the survival probability q = min(max throughput, cap).
        if (path_length + 1u >= parameters.roulette_start) {
            float survival_probability = min(max_component(throughput), parameters.survival_cap);
            if (!happens(survival_probability, seed)) break;
            throughput /= survival_probability;
        }
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
