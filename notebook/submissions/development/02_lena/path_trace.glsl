// Lena, exercise of chapter 2. The direction is sampled right here.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 sum = vec3(0.0);
    vec3 factor = vec3(1.0);
    for (uint n = 0u; n <= parameters.max_path_length; ++n) {
        Hit hit;
        bool is_hit = trace_ray(ray, NO_LIMIT, hit);
        if (!is_hit) {
            if (is_counted(n)) sum += factor * get_background_radiance(ray.direction);
            break;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(n)) sum += factor * s.emission;

        vec2 u = get_random_numbers(seed);
        float cos2 = 1.0 - u.x;  // in (0, 1]
        float azimuth = 2.0 * PI * u.y;
        vec3 local = vec3(sqrt(u.x) * vec2(cos(azimuth), sin(azimuth)), sqrt(cos2));
        vec3 omega = get_shading_space(s.normal) * local;

        bool ok = is_above_surface(s, s.out_direction) && is_above_surface(s, omega);
        if (!ok) break;

        // pi * brdf * cos / cos = albedo
        factor *= s.diffuse_albedo;
        ray = get_ray_from_surface(s, omega);
    }
    return sum;
}
