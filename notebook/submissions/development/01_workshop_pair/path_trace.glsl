// Path tracer of the slides, with our own coordinate system around the normal instead of get_shading_space().

// Two tangents for a unit normal.
void make_tangents(vec3 n, out vec3 t, out vec3 b) {
    vec3 helper = abs(n.y) > 0.999 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
    t = cross(helper, n);
    b = cross(n, t);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint k = 0u;; ++k) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(k)) radiance += throughput * get_background_radiance(ray.direction);
            break;
        }

        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(k)) radiance += throughput * s.emission;
        if (k == parameters.max_path_length) break;

        // Inclination and azimuth, both uniform.
        vec2 u = get_random_numbers(seed);
        float theta = u.y * 0.5 * PI;
        float phi = u.x * 2.0 * PI;

        vec3 t, b;
        make_tangents(s.normal, t, b);
        vec3 omega = sin(theta) * cos(phi) * t + sin(theta) * sin(phi) * b + cos(theta) * s.normal;
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, omega)) break;

        // pdf = 1 / (pi^2 sin theta), so we multiply with pi^2 sin theta
        throughput *= get_brdf(s, omega) * cos(theta) * sin(theta) * PI * PI;
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
