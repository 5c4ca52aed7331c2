// Cosine sampling by rejection: points of a square until one lies in the unit disk (probability π/4), lifted to the
// hemisphere. Neither roots of random numbers nor angles are needed.
vec3 sample_lifted_disk(inout uvec2 seed) {
    vec2 point;
    float square;
    do {
        point = 2.0 * get_random_numbers(seed) - 1.0;
        square = dot(point, point);
    } while (square >= 1.0);
    return vec3(point, sqrt(1.0 - square));
}

vec3 path_trace(Ray camera_ray, inout uvec2 seed) {
    vec3 picture = vec3(0.0);
    vec3 weight = vec3(1.0);
    Ray ray = camera_ray;
    int remaining = int(parameters.max_path_length);
    uint done = 0u;
    while (remaining-- >= 0) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(done)) picture += weight * get_background_radiance(ray.direction);
            return picture;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(done)) picture += weight * s.emission;
        ++done;

        // p = cos θ / π belongs to the point of the disk: its density is 1/π, and it is the direction's projection.
        vec3 local = sample_lifted_disk(seed);
        vec3 direction = normalize(get_shading_space(s.normal) * local);
        vec3 back = -ray.direction;
        if (!(is_above_surface(s, back) && is_above_surface(s, direction))) return picture;
        weight = weight * get_pi_brdf(s, direction, back);
        ray = get_ray_from_surface(s, direction);
    }
    return picture;
}
