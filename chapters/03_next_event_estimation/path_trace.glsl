// Chapter 3, next event estimation: the direct light at every hit comes from a random point y on the lights.
//
// Seen from x_k, an area dA of a light fills the solid angle dω = cos θ' / r² dA, with r = |y - x_k| and θ' between the
// light's normal and the direction to x_k. So the integral over directions becomes one over the area of all lights:
//     direct light = ∫ L_e(y) ρ n·ω cos θ' / r² V(x_k, y) dA(y),   V = 1 if nothing is between x_k and y, else 0.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "direct_light.glsl"

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint path_length = 0u;; ++path_length) {  // path_length is the slides' k-1
        // Trace the ray x_{k-1}, ω_{k-1}. If it misses all triangles, it sees the background.
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += throughput * get_background_radiance(ray.direction);
            break;
        }

        // Get the shading data at the hit point x_k. L_{e,k} is direct light at x_{k-1}, which a light sample has
        // estimated there. It must not be added again, except where the camera sees the light.
        ShadingData s = get_shading_data(hit, ray.direction);
        bool is_emission_new = path_length == 0u || STRATEGY == STRATEGY_BOUNCES;
        if (is_emission_new && is_counted(path_length)) radiance += throughput * s.emission;
        if (path_length == parameters.max_path_length) break;
        if (!is_above_surface(s, s.out_direction)) break;

        // The direct light at x_k arrives after one more bounce.
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct_light = sample_direct_light(s, seed);
            if (is_counted(path_length + 1u)) radiance += throughput * direct_light;
        }
        // The last ray could only find the background, or lights that have been sampled.
        if (STRATEGY != STRATEGY_BOUNCES && !HAS_BACKGROUND && path_length + 1u == parameters.max_path_length) break;

        // Sample ω_k = Q ω(u) in the hemisphere around the normal: density n·ω_k / π with respect to solid angle.
        vec2 u = get_random_numbers(seed);
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(u);
        if (!is_above_surface(s, omega)) break;

        // The weight ρ n·ω_k / (n·ω_k / π) = π ρ: the albedo of a Lambertian surface.
        throughput *= PI * get_brdf(s, omega);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
