// Chapter 8, light probes: light comes from all around, and light samples go to the bright directions.
//
// The probe is an image of all directions. Each of its cells, one a texel, is chosen with a probability P proportional to
// its mean luminance times its solid angle Δω. In it all directions are equally likely: density P/Δω with respect to
// solid angle. The weights of chapter 7 do the rest. Where there are light triangles, too, each light sample goes either
// to them or to the probe; their densities hold the probability of that choice.
#include "multiple_importance_sampling.glsl"

// p_l of a direction that misses all triangles. It is looked up for light samples as well as for bounces, so that their
// weights add up to one, however inexactly a device computes where a direction is on the probe.
float get_light_probe_density(vec3 direction) {
    if (!LIGHT_PROBE_SAMPLING) return 0.0;
    uvec2 count = get_probe_cell_count();
    vec2 position = get_probe_position(direction);
    uvec2 cell = min(uvec2(fract(position.x) * count.x, position.y * count.y), count - 1u);
    return get_probe_cell_density(cell.y * count.x + cell.x);
}

// A unit direction with the density P/Δω.
vec3 sample_light_probe_direction(inout uvec2 seed, out float density) {
    uint index = choose_probe_cell(seed);
    density = get_probe_cell_density(index);
    uvec2 count = get_probe_cell_count();
    uvec2 cell = uvec2(index % count.x, index / count.x);

    // The azimuth is uniform, and so is cos θ between the cell's edges. Close to the pole all cos θ are close to 1, so
    // that 1 - cos θ = 2 sin² θ/2 is sampled instead. The lower half is mirrored for it.
    vec2 u = get_random_numbers(seed);
    bool is_lower = 2u * cell.y >= count.y;
    float row = float(is_lower ? count.y - 1u - cell.y : cell.y);
    float edge = sin(0.5 * PI * row / count.y), next_edge = sin(0.5 * PI * (row + 1.0) / count.y);
    float one_minus_cos = 2.0 * mix(edge * edge, next_edge * next_edge, u.y);
    float sin_theta = sqrt(one_minus_cos * (2.0 - one_minus_cos));
    float azimuth = 2.0 * PI * ((cell.x + u.x) / count.x - 0.5) - parameters.probe_rotation;
    float height = is_lower ? one_minus_cos - 1.0 : 1.0 - one_minus_cos;
    return vec3(sin_theta * sin(azimuth), height, -sin_theta * cos(azimuth));
}

// The light of the probe that x_k reflects into a direction, as far as it is left to one direction to the probe.
vec3 sample_light_probe(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    float sampled_density;
    vec3 omega = sample_light_probe_direction(seed, sampled_density);
    // Rarely the look-up rounds to a black cell beside the sampled one, where nothing shines.
    float light_density = get_light_probe_density(omega);
    if (!is_above_surface(s, omega) || light_density == 0.0) return vec3(0.0);
    if (is_occluded(get_ray_from_surface(s, omega), NO_LIMIT)) return vec3(0.0);

    // The last factor is 1, but where the look-up rounds to another cell.
    return get_light_sample_weight(s, omega, out_direction, light_density) * get_background_radiance(omega) *
           (light_density / sampled_density);
}

// The direct light at x_k by one light sample: of the probe or of the light triangles.
vec3 sample_direct_light(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    bool is_from_probe = LIGHT_PROBE_SAMPLING && (!LIGHT_SAMPLING || happens(LIGHT_PROBE_PROBABILITY, seed));
    return is_from_probe ? sample_light_probe(s, out_direction, seed) : sample_light_triangle(s, out_direction, seed);
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
            float light_density = is_light_sampled ? get_light_probe_density(ray.direction) : 0.0;
            if (is_counted(path_length))
                radiance += radiance_scale * throughput * get_bounce_part(light_density, bounce_density) *
                            get_background_radiance(ray.direction);
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
