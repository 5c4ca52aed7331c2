// Chapter 1: path tracing with uniformly sampled angles.

// The z-axis is the normal here.
vec3 from_angles(float theta, float phi) {
    return vec3(cos(phi) * sin(theta), sin(phi) * sin(theta), cos(theta));
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);

    // The two random angles
    vec2 u = get_random_numbers(seed);
    float theta = 0.5 * PI * u.y;
    float phi = 2.0 * PI * u.x - PI;
    vec3 local_direction = from_angles(theta, phi);

    for (uint path_length = 0u;; ++path_length) {
        // Intersect
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += throughput * get_background_radiance(ray.direction);
            break;
        }

        // Emission
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(path_length)) radiance += throughput * s.emission;
        if (path_length == parameters.max_path_length) break;

        // Bounce
        vec3 omega = get_shading_space(s.normal) * local_direction;
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, omega)) break;
        throughput *= PI * PI * get_brdf(s, omega) * dot(s.normal, omega) * sin(theta);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
