// One pass of the loop is one bounce.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 color = vec3(0.0);
    vec3 throughput = vec3(1.0);
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : color;

    for (uint bounce = 0u; bounce < max(parameters.max_path_length, 1u); ++bounce) {
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(bounce)) color += throughput * s.emission;
        if (parameters.max_path_length == 0u) break;

        vec2 xi = get_random_numbers(seed);
        float theta = xi.y * PI / 2.0, phi = (2.0 * xi.x - 1.0) * PI;
        vec3 wi = get_shading_space(s.normal) * vec3(cos(phi) * sin(theta), sin(phi) * sin(theta), cos(theta));
        if (!(is_above_surface(s, s.out_direction) && is_above_surface(s, wi))) break;
        throughput *= get_brdf(s, wi) * (cos(theta) * sin(theta) * PI * PI);

        ray = get_ray_from_surface(s, wi);
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(bounce + 1u)) color += throughput * get_background_radiance(ray.direction);
            break;
        }
    }
    return color;
}
