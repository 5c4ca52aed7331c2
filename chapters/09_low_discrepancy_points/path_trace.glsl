// Chapter 9, low-discrepancy points: the samples of a pixel know of each other, and each goes where the others have left
// a gap.
//
// Random points clump. The points of Sobol's sequence do not: of its first 2^k points each rectangle of area 2^-k, however
// its 2^-i × 2^(i-k) lies in the grid, holds exactly one. Owen scrambling moves them at random and keeps this property.
// Each point alone becomes uniform, so that the estimator stays unbiased. A path needs many pairs of numbers: each is a
// point of the same sequence, with scrambles and an order of its own, so that the pairs do not depend on each other.
//
// What calls for random numbers stays as it is: only their source is another one.
#include "light_probe_sampling.glsl"

// Owen scrambling of a number whose bits are reversed: each bit is flipped or not, by a hash of the key and all digits
// before it, which here are the lower bits. Sums and products carry upwards only. Constants: Vegdahl, "Building a Better
// LK Hash", 2021; the idea: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4) 2020.
uint scramble_reversed(uint bits, uint key) {
    bits ^= bits * 0x3d20adeau;
    bits += key;
    bits *= (key >> 16u) | 1u;
    bits ^= bits * 0x05526c56u;
    bits ^= bits * 0x53a22864u;
    return bits;
}

// The second dimension of Sobol's sequence, with its bits reversed: the index times Pascal's triangle modulo 2. The
// triangle of 2^k rows consists of copies of that of half the size, and so five steps suffice. The first dimension, van
// der Corput's sequence, is the index itself.
uint get_second_dimension(uint index) {
    index ^= (index & 0xaaaaaaaau) >> 1u;
    index ^= (index & 0xccccccccu) >> 2u;
    index ^= (index & 0xf0f0f0f0u) >> 4u;
    index ^= (index & 0xff00ff00u) >> 8u;
    index ^= (index & 0xffff0000u) >> 16u;
    return index;
}

// The sample's index and a hash, of the pixel and of the scramble. Samples 2^k to 2^(k+1) - 1 share a scramble and fill
// the unit square evenly. Those before have others. So whenever the samples of a pixel double, the new ones are
// independent of the old ones, and the difference of the halves tells the error.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uint scramble = uint(findMSB(sample_index) + 1);
    return uvec2(sample_index, get_state(pixel_index, scramble, key).x);
}

// The words of the pixel's next point. The hash in the state counts on, so that it comes back after 2^32 pairs only: a
// hash of a hash of a hash would soon go round in circles.
uvec2 get_random_words(inout uvec2 seed) {
    uvec2 keys = uvec2(seed.y, 0u);
    advance_random_state(keys);
    uint index = bitfieldReverse(scramble_reversed(bitfieldReverse(seed.x), keys.x));
    advance_random_state(keys);
    uvec2 point = uvec2(scramble_reversed(index, keys.x), scramble_reversed(get_second_dimension(index), keys.y));
    seed.y += 0x9e3779b9u;
    return bitfieldReverse(point);
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
