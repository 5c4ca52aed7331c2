// Cosine sampling without angles: put a ball of radius 1 on the surface so that it touches x_k, its centre is x_k + n. The direction to
// a random point of the ball is distributed like the cosine.

vec3 random_in_ball(inout uvec2 seed) {
    for (;;) {
        vec2 xy = get_random_numbers(seed);
        float z = get_random_numbers(seed).x;
        vec3 p = 2.0 * vec3(xy, z) - 1.0;
        if (dot(p, p) < 1.0) return p;
    }
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 attenuation = vec3(1.0);
    for (uint depth = 0u;; ++depth) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(depth)) radiance += attenuation * get_background_radiance(ray.direction);
            break;
        }
        ShadingData rec = get_shading_data(hit, ray.direction);
        if (is_counted(depth)) radiance += attenuation * rec.emission;
        if (depth >= parameters.max_path_length) break;

        vec3 target = rec.normal + random_in_ball(seed);
        vec3 scattered = normalize(target);
        if (!is_above_surface(rec, rec.out_direction) || !is_above_surface(rec, scattered)) break;

        // cosine and density cancel, what stays is pi * brdf
        attenuation *= PI * get_brdf(rec, scattered);
        ray = get_ray_from_surface(rec, scattered);
    }
    return radiance;
}
