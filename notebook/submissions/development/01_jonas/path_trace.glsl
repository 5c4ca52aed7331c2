vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 color = vec3(0.0);
    vec3 weight = vec3(1.0);

    for (uint bounce = 0u; bounce <= parameters.max_path_length; bounce++) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            // sky
            if (is_counted(bounce)) color += weight * get_background_radiance(ray.direction);
            break;
        }
        ShadingData sd = get_shading_data(hit, ray.direction);

        // lamp
        if (sd.emission.x + sd.emission.y + sd.emission.z > 0.0) {
            if (is_counted(bounce)) color += weight * sd.emission;
            break;
        }

        // new direction
        vec2 xi = get_random_numbers(seed);
        float theta = xi.y * PI / 2.0;
        float phi = xi.x * PI * 2.0;
        vec3 d = vec3(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
        vec3 dir = get_shading_space(sd.normal) * d;
        if (!is_above_surface(sd, sd.out_direction)) break;
        if (!is_above_surface(sd, dir)) break;

        weight *= get_brdf(sd, dir) * d.z * sin(theta) * PI * PI;
        ray = get_ray_from_surface(sd, dir);
    }
    return color;
}
