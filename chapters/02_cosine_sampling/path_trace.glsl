// Chapter 2, cosine sampling: directions are chosen with a density proportional to the cosine of the rendering
// equation.
//
// Then the cosine cancels, and the estimator of the slides becomes L_{k-1} = L_{e,k} + L_k π ρ(x_k, ω_k, -ω_{k-1}).

// Direction about the z-axis for u uniform in [0,1)². Never horizontal: cos θ = √(1 - u_y) > 0.
vec3 sample_hemisphere(vec2 u) {
    float phi = 2.0 * PI * u.x - PI;
    float sin_theta = sqrt(u.y);
    return vec3(cos(phi) * sin_theta, sin(phi) * sin_theta, sqrt(1.0 - u.y));
}

// The density of sample_hemisphere() with respect to solid angle: cos θ / π in the upper hemisphere.
float get_hemisphere_density(vec3 direction) { return max(direction.z, 0.0) / PI; }

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
        vec2 u = get_random_numbers(seed);
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(u);
        vec3 out_direction = -ray.direction;
        if (!is_above_surface(s, out_direction) || !is_above_surface(s, omega)) break;

        // The weight ρ n·ω_k / (n·ω_k / π) = π ρ: exactly the albedo of a Lambertian surface.
        throughput *= get_pi_brdf(s, omega, out_direction);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
