// Exercise 1, Marta. Directions come from rejection sampling: throw points into the upper half of the cube until one lies in the
// ball. Pushed onto the sphere they are uniform, each direction of the hemisphere has the density 1/(2 pi).

vec3 random_up_direction(inout uvec2 seed) {
    vec3 p;
    float r2;
    do {
        vec2 a = get_random_numbers(seed);
        vec2 b = get_random_numbers(seed);
        p = vec3(2.0 * a.x - 1.0, 2.0 * a.y - 1.0, b.x);
        r2 = dot(p, p);
    } while (r2 > 1.0 || r2 < 1e-6);
    return p / sqrt(r2);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 L = vec3(0.0);
    vec3 beta = vec3(1.0);
    uint depth = 0u;
    while (true) {
        Hit hit;
        bool found = trace_ray(ray, NO_LIMIT, hit);
        if (!found) {
            if (is_counted(depth)) L += beta * get_background_radiance(ray.direction);
            return L;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(depth)) L += beta * s.emission;
        if (depth == parameters.max_path_length) return L;
        depth++;

        vec3 local = random_up_direction(seed);
        vec3 wi = get_shading_space(s.normal) * local;
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, wi)) return L;

        // brdf * cos / pdf with pdf = 1 / (2 pi)
        beta *= get_brdf(s, wi) * local.z * (2.0 * PI);
        ray = get_ray_from_surface(s, wi);
    }
    return L;
}
