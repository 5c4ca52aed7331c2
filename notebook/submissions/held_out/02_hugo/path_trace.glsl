// Chapter 2. Cosine distribution without any basis: the normal plus a uniform point on the unit sphere points into a
// direction whose density is cos(theta)/pi. (The unit sphere that touches the surface in x: its points are uniform, and a
// cap of it appears from x under half of the angle.)

vec3 uniform_on_sphere(vec2 u) {
    float z = 1.0 - 2.0 * u.x;
    float r = sqrt(max(0.0, 1.0 - z * z));
    float a = 2.0 * PI * u.y;
    return vec3(r * cos(a), r * sin(a), z);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 L = vec3(0.0), beta = vec3(1.0);

    for (uint k = 0u; true; k++) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            L += is_counted(k) ? beta * get_background_radiance(ray.direction) : vec3(0.0);
            break;
        }

        ShadingData s = get_shading_data(hit, ray.direction);
        L += is_counted(k) ? beta * s.emission : vec3(0.0);

        if (k >= parameters.max_path_length) break;
        if (!is_above_surface(s, s.out_direction)) break;

        vec3 w = s.normal + uniform_on_sphere(get_random_numbers(seed));
        float len = length(w);
        if (len < 1e-6) break;  // opposite to the normal: never in practice
        w /= len;
        if (!is_above_surface(s, w)) break;

        beta *= get_brdf(s, w) * PI;  // cos and pdf cancel
        ray = get_ray_from_surface(s, w);
    }

    return L;
}
