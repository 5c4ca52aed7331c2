// Sobol's second dimension by its direction numbers, and Owen scrambling as Burley publishes it: by the hash of Laine and
// Karras. The keys of a pair are hashes of its number.
#include "light_probe_sampling.glsl"

uint laine_karras(uint x, uint key) {
    x += key;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

uint owen(uint x, uint key) { return bitfieldReverse(laine_karras(bitfieldReverse(x), key)); }

uint sobol(uint index) {
    uint result = 0u;
    for (uint v = 1u << 31u; index != 0u; index >>= 1u, v ^= v >> 1u)
        if ((index & 1u) != 0u) result ^= v;
    return result;
}

// Wellons' hash of 32 bits.
uint mix_bits(uint x) {
    x = 0x7feb352du * (x ^ (x >> 16u));
    x = 0x846ca68bu * (x ^ (x >> 15u));
    return x ^ (x >> 16u);
}

// Samples of a scramble are numbered from 0.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uint octave = sample_index == 0u ? 0u : uint(findMSB(sample_index)) + 1u;
    uint first = octave == 0u ? 0u : 1u << (octave - 1u);
    uint hash = mix_bits(key.y ^ mix_bits(pixel_index ^ mix_bits(key.x + octave)));
    return uvec2(sample_index - first, hash);
}

uvec2 get_random_words(inout uvec2 seed) {
    uint base = mix_bits(seed.y + 0x9e3779b9u);
    seed.y = base;
    uint shuffled = owen(seed.x, mix_bits(base ^ 1u));
    return uvec2(owen(bitfieldReverse(shuffled), mix_bits(base ^ 2u)), owen(sobol(shuffled), mix_bits(base ^ 3u)));
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
