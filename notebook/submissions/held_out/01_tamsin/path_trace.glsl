// Exercise for chapter 1 -- Tamsin
vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint path_length = 0u;; ++path_length) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += throughput * get_background_radiance(ray.direction);
            break;
        }

        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(path_length)) radiance += throughput * s.emission;
        if (path_length == parameters.max_path_length) break;

        // Choose the direction. We don't need theta itself, only its sine and cosine, so no expensive cos() and sin().
        vec2 u = get_random_numbers(seed);
        float cos_theta = u.y;
        float sin_theta = sqrt(1.0 - cos_theta * cos_theta);
        float phi = 2.0 * PI * u.x - PI;
        vec3 omega = get_shading_space(s.normal) * vec3(sin_theta * cos(phi), sin_theta * sin(phi), cos_theta);

        bool can_go_on = is_above_surface(s, s.out_direction) && is_above_surface(s, omega);
        if (!can_go_on) break;

        // The slides: pi^2 rho (n . omega) sin(theta)
        throughput *= PI * PI * get_brdf(s, omega) * cos_theta * sin_theta;
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
