// Lambertian bounces as in "Ray Tracing in One Weekend": take the normal and add a random point of the unit sphere.

vec3 random_in_unit_sphere(inout uvec2 seed) {
    vec2 a = get_random_numbers(seed);
    float b = get_random_numbers(seed).x;
    float z = 2.0 * a.x - 1.0;
    float phi = 2.0 * PI * a.y;
    float r = pow(b, 1.0 / 3.0);
    return r * vec3(sqrt(1.0 - z * z) * cos(phi), sqrt(1.0 - z * z) * sin(phi), z);
}

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

        vec3 target = s.normal + random_in_unit_sphere(seed);
        vec3 omega = normalize(target);
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, omega)) break;

        // The cosine cancels with the density, what remains is the albedo.
        throughput *= PI * get_brdf(s, omega);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
