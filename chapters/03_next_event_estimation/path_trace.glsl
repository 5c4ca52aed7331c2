// Chapter 3, next event estimation: the direct light at every hit comes from a random point y on the lights.
//
// Seen from x_k, an area dA of a light fills the solid angle dω = cos θ' / r² dA, with r = |y - x_k| and θ' between the
// light's normal and the direction to x_k. So the integral over directions becomes one over the area of all lights:
//     direct light = ∫ L_e(y) ρ n·ω cos θ' / r² V(x_k, y) dA(y),   V = 1 if nothing is between x_k and y, else 0.
#include "sampling.glsl"

// Estimates the direct light that x_k reflects into a direction, by one point y on the lights.
vec3 sample_direct_light(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    // A triangle with probability P proportional to its area A times the luminance of its emission. On it a uniform
    // point y: the root makes up for the triangle's narrowing towards the first vertex. Density P/A with respect to
    // area.
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

    // The weight ρ n·ω cos θ' / r² A/P.
    float geometry = dot(s.normal, omega) * cos_light / (distance * distance);
    return get_pi_brdf(s, omega, out_direction) / PI * geometry * light.inverse_density * y.emission;
}

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

        // Get the shading data at the hit point x_k. L_{e,k} is direct light at x_{k-1}, which has been estimated
        // there: it must not be added again, except where the camera sees the light.
        ShadingData s = get_shading_data(hit, ray.direction);
        bool is_emission_new = path_length == 0u || !LIGHT_SAMPLING;
        if (is_emission_new && is_counted(path_length)) radiance += throughput * s.emission;
        if (path_length == parameters.max_path_length) break;
        vec3 out_direction = -ray.direction;
        if (!is_above_surface(s, out_direction)) break;

        // The direct light at x_k arrives after one bounce more.
        if (LIGHT_SAMPLING) {
            vec3 direct_light = sample_direct_light(s, out_direction, seed);
            if (is_counted(path_length + 1u)) radiance += throughput * direct_light;
        }
        // The last ray could only find lights that have been sampled, or the background.
        if (LIGHT_SAMPLING && !HAS_BACKGROUND && path_length + 1u == parameters.max_path_length) break;

        // Sample ω_k = Q ω(u) in the hemisphere around the normal: density n·ω_k / π with respect to solid angle.
        vec2 u = get_random_numbers(seed);
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(u);
        if (!is_above_surface(s, omega)) break;

        // The weight ρ n·ω_k / (n·ω_k / π) = π ρ: exactly the albedo of a Lambertian surface.
        throughput *= get_pi_brdf(s, omega, out_direction);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
