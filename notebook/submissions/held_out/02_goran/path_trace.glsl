// Chapter 2, cosine sampling: directions are chosen with a density proportional to the cosine of the rendering
// equation.
//
// Then the cosine cancels, and the estimator of the slides becomes L_{k-1} = L_{e,k} + L_k π ρ(x_k, ω_k, -ω_{k-1}).
#include "sample_hemisphere.glsl"

// A random point in the unit ball.
vec3 random_in_unit_sphere(inout uvec2 seed) {
    vec2 u = get_random_numbers(seed);
    float r = pow(get_random_numbers(seed).x, 1.0 / 3.0);
    float z = 1.0 - 2.0 * u.y;
    float phi = 2.0 * PI * u.x;
    return r * vec3(sqrt(1.0 - z * z) * cos(phi), sqrt(1.0 - z * z) * sin(phi), z);
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

        // Get the shading data at the hit point x_k and add the emitted radiance L_{e,k}.
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(path_length)) radiance += throughput * s.emission;
        if (path_length == parameters.max_path_length) break;

        // Sample ω_k = Q ω(u) in the hemisphere around the normal: density n·ω_k / π with respect to solid angle.
        vec3 omega = normalize(s.normal + random_in_unit_sphere(seed));
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, omega)) break;

        // The weight ρ n·ω_k / (n·ω_k / π) = π ρ: the albedo of a Lambertian surface.
        throughput *= PI * get_brdf(s, omega);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
