// Exercise 1. I sample directions with the constant density 1/(2 pi) over the hemisphere (the "uniform" of the textbook by
// Pharr et al.): by Archimedes' hat-box theorem the height of the direction is uniform in [0,1).

// My own frame, with the normal as third column.
mat3 make_frame(vec3 n) {
    vec3 helper = abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    vec3 t = normalize(cross(helper, n));
    return mat3(t, cross(n, t), n);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 sum = vec3(0.0);
    vec3 beta = vec3(1.0);
    uint bounces = 0u;
    while (true) {
        Hit hit;
        bool hits_something = trace_ray(ray, NO_LIMIT, hit);
        if (!hits_something) {
            if (is_counted(bounces)) sum += beta * get_background_radiance(ray.direction);
            return sum;
        }

        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(bounces)) sum += beta * s.emission;
        if (bounces == parameters.max_path_length) return sum;

        vec2 u = get_random_numbers(seed);
        float height = u.x;
        float radius = sqrt(1.0 - height * height);
        float azimuth = 2.0 * PI * u.y;
        vec3 local = vec3(radius * cos(azimuth), radius * sin(azimuth), height);
        vec3 omega = make_frame(s.normal) * local;

        if (!is_above_surface(s, s.out_direction)) return sum;
        if (!is_above_surface(s, omega)) return sum;

        // f cos / pdf with pdf = 1 / (2 pi)
        const float one_over_pdf = 2.0 * PI;
        beta *= get_brdf(s, omega) * height * one_over_pdf;
        ray = get_ray_from_surface(s, omega);
        bounces++;
    }
}
