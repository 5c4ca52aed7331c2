// Chapter 7, multiple importance sampling: light is found by light samples and by bounces, and each find counts with a
// weight.
//
// A light sample finds a direction with density p_l, a bounce with density p_b, both with respect to solid angle. With
// the balance heuristic the first counts p_l / (p_l + p_b) and the second p_b / (p_l + p_b). The weights add up to one,
// so that no light is counted twice, and whichever way is better at a place takes most of it.
//
// Bounces sample the whole BRDF now: a glossy surface reflects most light into few directions. Splitting is gone, since
// it hardly pays. So one loop is enough again, with one place that traces.
#include "brdf_sampling.glsl"
#include "dielectrics.glsl"

// Turns a density with respect to area into one with respect to solid angle: dω = cos θ' / r² dA.
float to_solid_angle(float area_density, float distance, float cos_light) {
    return area_density * distance * distance / cos_light;
}

// The part of what a bounce finds that counts: p_b / (p_l + p_b), or all of it where light samples find nothing.
float get_bounce_part(float light_density, float bounce_density) {
    return light_density > 0.0 ? bounce_density / (light_density + bounce_density) : 1.0;
}

// The factor of what a light sample finds: ρ n·ω / p_l · p_l / (p_l + p_b) = ρ n·ω / (p_l + p_b). It stays finite where a
// light comes close to x_k, while chapter 3's 1/r² does not.
vec3 get_light_sample_weight(ShadingData s, vec3 omega, vec3 out_direction, float light_density) {
    float bounce_density = BOUNCES_FIND_LIGHTS ? get_brdf_density(s, omega, out_direction) : 0.0;
    return get_pi_brdf(s, omega, out_direction) * (dot(s.normal, omega) / PI / (light_density + bounce_density));
}

// The direct light that x_k reflects into a direction, as far as it is left to one point y on the lights.
vec3 sample_light_triangle(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    // A uniform point on a triangle that is chosen with probability P: density P/A with respect to area.
    LightTriangle light = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));

    // Both cosines must be positive. Lights emit from the front only.
    vec3 to_light = y.position - s.position;
    float distance = length(to_light);
    vec3 omega = to_light / distance;
    float cos_light = dot(y.normal, -omega);
    if (!(cos_light > 0.0) || !is_above_surface(s, omega)) return vec3(0.0);

    // V: a shadow ray that ends just short of the light.
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);

    // The last factor is 1, but for the rounding of P in the alias table.
    float light_density = to_solid_angle(y.light_density, distance, cos_light);
    return get_light_sample_weight(s, omega, out_direction, light_density) * y.emission *
           (light.inverse_density * y.light_density);
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
            if (is_counted(path_length))
                radiance += radiance_scale * throughput * get_background_radiance(ray.direction);
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
        is_light_sampled = LIGHT_SAMPLING && !s.is_dielectric;
        if (is_light_sampled) {
            vec3 direct_light = sample_light_triangle(s, out_direction, seed);
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

        // Russian roulette with the survival probability q = min(max throughput / β_s, cap).
        if (path_length + 1u >= parameters.roulette_start) {
            float survival_probability =
                min(max_component(throughput) / parameters.survival_weight, parameters.survival_cap);
            if (!happens(survival_probability, seed)) break;
            throughput /= survival_probability;
        }
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
