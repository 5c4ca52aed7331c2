// Solution of the exercise. I draw z = cos(theta) uniformly (Archimedes' hat box), which makes the points uniform on the hemisphere.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    uint path_length = 0u;
    for (;;) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += throughput * get_background_radiance(ray.direction);
            break;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(path_length)) radiance += throughput * s.emission;
        if (path_length++ == parameters.max_path_length) break;

        vec2 u = get_random_numbers(seed);
        float z = u.x;
        float r = sqrt(max(0.0, 1.0 - z * z));
        float phi = 2.0 * PI * u.y;
        vec3 omega = get_shading_space(s.normal) * vec3(r * cos(phi), r * sin(phi), z);
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, omega)) break;

        // The density is 1 over the area of the hemisphere, so the weight is 2 pi rho (n . omega). No sine: it is in z already.
        throughput *= 2.0 * PI * z * get_brdf(s, omega);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
