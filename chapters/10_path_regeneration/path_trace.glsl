// Chapter 10, path regeneration: no thread waits for the longest path.
//
// The threads of a GPU run in groups, called warps or subgroups, that execute the same instruction together. In chapter 9
// a thread whose path has ended waits until the longest path of its group has ended, too. Here the estimator is a single
// bounce. The loop over bounces and samples in render_samples.glsl is one loop, so that such a thread starts its next
// sample at once, while its neighbours go on with theirs (Novák, Havran and Dachsbacher, "Path Regeneration for
// Interactive Path Tracing", Eurographics 2010). Each sample is that of chapter 9, to the bit.
#define PATH_REGENERATION
#include "light_probe_sampling.glsl"
#include "low_discrepancy.glsl"

// What a path carries from bounce to bounce: the variables of chapter 9's loop.
struct Path {
    Ray ray;  // x_{k-1}, ω_{k-1}
    vec3 radiance;
    vec3 throughput;
    uint path_length;       // the slides' k-1
    float radiance_scale;   // 1/η² for every medium entered, see chapter 6
    bool is_light_sampled;  // whether x_{k-1} has a light sample, too
    float bounce_density;   // p_b of the ray's direction, where it has
};

Path start_path(Ray ray) { return Path(ray, vec3(0.0), vec3(1.0), 0u, 1.0, false, 0.0); }

// Extends the path by one bounce, with all radiance that it finds there. Returns false where it ends.
bool extend_path(inout Path path, inout uvec2 seed) {
    // Trace the ray x_{k-1}, ω_{k-1}. If it misses all triangles, it sees the background.
    Hit hit;
    if (!trace_ray(path.ray, NO_LIMIT, hit)) {
        float light_density = path.is_light_sampled ? get_light_probe_density(path.ray.direction) : 0.0;
        if (is_counted(path.path_length))
            path.radiance += path.radiance_scale * path.throughput *
                             get_bounce_part(light_density, path.bounce_density) *
                             get_background_radiance(path.ray.direction);
        return false;
    }

    // The emitted radiance L_{e,k}, or the part of it that x_{k-1}'s light sample leaves to this bounce.
    ShadingData s = get_shading_data(hit, path.ray.direction);
    vec3 out_direction = -path.ray.direction;
    path.throughput *= s.transmittance;
    float cos_light = dot(s.geometric_normal, out_direction);
    float light_density = path.is_light_sampled ? to_solid_angle(s.light_density, hit.distance, cos_light) : 0.0;
    if (is_counted(path.path_length))
        path.radiance += path.radiance_scale * path.throughput *
                         get_bounce_part(light_density, path.bounce_density) * s.emission;
    if (path.path_length == parameters.max_path_length || !is_above_surface(s, out_direction)) return false;

    // The direct light at x_k arrives after one bounce more. No light sample meets a dielectric's directions.
    path.is_light_sampled = (LIGHT_SAMPLING || LIGHT_PROBE_SAMPLING) && !s.is_dielectric;
    if (path.is_light_sampled) {
        vec3 direct_light = sample_direct_light(s, out_direction, seed);
        if (is_counted(path.path_length + 1u)) path.radiance += path.radiance_scale * path.throughput * direct_light;
    }

    // Sample ω_k: at a dielectric one of two directions, elsewhere with density p_b.
    vec3 omega;
    if (s.is_dielectric) {
        omega = sample_dielectric(s, out_direction, seed);
        bool is_refracted = dot(s.normal, omega) < 0.0;
        if (is_refracted != (dot(s.geometric_normal, omega) < 0.0)) return false;
        if (is_refracted) path.radiance_scale /= s.relative_index * s.relative_index;
    } else {
        omega = sample_brdf(s, out_direction, seed);
        if (!is_above_surface(s, omega)) return false;
        // The weight ρ n·ω / p_b: exactly the albedo of a Lambertian surface.
        float density = get_brdf_density(s, omega, out_direction);
        path.throughput *= get_pi_brdf(s, omega, out_direction) * (dot(s.normal, omega) / PI / density);
        path.bounce_density = BOUNCES_FIND_LIGHTS ? density : 0.0;
    }

    // Russian roulette with the survival probability q = min(max throughput / β_s, cap).
    if (path.path_length + 1u >= parameters.roulette_start) {
        float survival_probability =
            min(max_component(path.throughput) / parameters.survival_weight, parameters.survival_cap);
        if (!happens(survival_probability, seed)) return false;
        path.throughput /= survival_probability;
    }
    path.ray = get_ray_from_surface(s, omega);
    ++path.path_length;
    return true;
}

// The whole path at once, as in the chapters before.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    Path path = start_path(ray);
    while (extend_path(path, seed)) {
    }
    return path.radiance;
}
