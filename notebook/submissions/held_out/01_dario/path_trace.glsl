#define saturate(x) clamp(x, 0.0, 1.0)

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 col = vec3(0.0);
    vec3 mask = vec3(1.0);
    for (uint depth = 0u; depth <= parameters.max_path_length; ++depth) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(depth)) col += mask * get_background_radiance(ray.direction);
            break;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(depth)) col += mask * s.emission;
        if (depth == parameters.max_path_length) break;

        vec2 xi = get_random_numbers(seed);
        float theta = xi.y * PI * 0.5;
        float phi = xi.x * PI * 2.0;
        vec3 dir = get_shading_space(s.normal) * vec3(cos(phi) * sin(theta), sin(phi) * sin(theta), cos(theta));
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, dir)) break;

        float ndotl = saturate(dot(s.normal, dir));
        mask *= get_brdf(s, dir) * ndotl * sin(theta) * PI * PI;
        ray = get_ray_from_surface(s, dir);
    }
    // get rid of the white dots
    return clamp(col, 0.0, 5.0);
}
