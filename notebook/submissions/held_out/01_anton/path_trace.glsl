// Path tracer with random directions over the hemisphere.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 result = vec3(0.0);
    vec3 beta = vec3(1.0);
    uint bounces = 0u;
    while (true) {
        Hit hit;
        bool found = trace_ray(ray, NO_LIMIT, hit);
        if (!found) {
            if (is_counted(bounces)) result += beta * get_background_radiance(ray.direction);
            return result;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(bounces)) result += beta * s.emission;
        if (bounces == parameters.max_path_length) return result;

        // spherical coordinates
        vec2 u = get_random_numbers(seed);
        float phi = 2.0 * PI * u.x;
        float theta = acos(u.y);
        vec3 local = vec3(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
        vec3 omega = get_shading_space(s.normal) * local;
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, omega)) return result;

        beta *= PI * PI * get_brdf(s, omega) * cos(theta) * sin(theta);
        ray = get_ray_from_surface(s, omega);
        ++bounces;
    }
}
