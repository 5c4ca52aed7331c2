// Owen scrambling as it is defined: a coin for each node of the tree of digits. Of the digits behind the 16th, which move a
// point by less than 2^-16, a hash decides at once.
#include "light_probe_sampling.glsl"

uint coin(uint level, uint path, uint key) {
    uvec2 state = uvec2(path ^ key, key + 0x632be59bu * (level + 1u));
    advance_random_state(state);
    return state.x >> 31u;
}

// Flips the first 16 digits of a number, the highest first.
uint flip_digits(uint number, uint key) {
    uint result = 0u;
    for (uint level = 0u; level < 16u; ++level) {
        uint path = level == 0u ? 0u : number >> (32u - level);
        uint digit = number >> (31u - level) & 1u;
        result = result << 1u | (digit ^ coin(level, path, key));
    }
    uvec2 rest = uvec2(number, key);
    advance_random_state(rest);
    return result << 16u | rest.y >> 16u;
}

// Points 0, 1, ... of the sequence: the index backwards, and its product with Pascal's triangle.
uvec2 get_sobol_point(uint index) {
    uint second = 0u;
    for (uint row = 1u << 31u, digits = index; digits != 0u; digits >>= 1u, row ^= row >> 1u)
        second ^= (digits & 1u) * row;
    return uvec2(bitfieldReverse(index), second);
}

uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uint bits = 0u;
    while (bits < 32u && sample_index >> bits != 0u) ++bits;
    uvec2 state = get_state(pixel_index, bits, key.yx);
    return uvec2(sample_index - (bits == 0u ? 0u : 1u << (bits - 1u)), state.y);
}

// An order by a bijection that keeps every aligned block of 2^k indices together: digits are flipped by the higher ones, of
// which only the lowest 16 differ.
uvec2 get_random_words(inout uvec2 seed) {
    uvec2 keys = uvec2(0x5bd1e995u, seed.y), others = keys;
    advance_random_state(keys);
    others = keys;
    advance_random_state(others);
    seed.y = others.y;
    uint place = flip_digits(seed.x << 16u, keys.x) >> 16u;
    uvec2 point = get_sobol_point(place);
    return uvec2(flip_digits(point.x, keys.y), flip_digits(point.y, others.x));
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
