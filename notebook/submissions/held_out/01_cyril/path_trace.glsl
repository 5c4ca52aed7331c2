// Chapter 1, uniform sampling: the path tracer of the slides. Inclination θ and azimuth φ are sampled uniformly.
//
// On the slides path_trace(x_{k-1}, ω_{k-1}, k-1) calls itself to estimate the radiance L_k that arrives at x_k:
//     L_{k-1} = L_{e,k} + π² L_k ρ(x_k, ω_k, -ω_{k-1}) n(x_k)·ω_k sin(π/2 u_y)
// A shader cannot recurse, so this is a loop. Instead of multiplying L_k on the way back, it carries the product of the factors
// π² ρ n·ω sin(π/2 u_y) of all bounces so far, called throughput, and adds throughput · L_{e,k} at every hit.
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

        // Sample ω_k = Q ω(u) in the hemisphere around the normal: density 1/(π² sin θ) with respect to solid angle.
        vec2 u = get_random_numbers(seed);
        float theta = 0.5 * PI * u.y;
        float phi = 2.0 * PI * u.x - PI;
        float cos_theta = cos(theta);
        float sin_theta = sin(theta);
        vec3 omega = get_shading_space(s.normal) * vec3(cos(phi) * sin_theta, sin(phi) * sin_theta, cos_theta);
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, omega)) break;

        // The weight π² ρ n·ω_k sin(π/2 u_y). As a product, without a division by the density, it is finite everywhere.
        throughput *= PI * PI * get_brdf(s, omega) * cos_theta * sin_theta;
        // a small epsilon against self-intersection
        ray = Ray(s.position + 0.05 * omega, omega);
    }
    return radiance;
}
