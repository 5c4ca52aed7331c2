// Cosine sampling by Malley's method: a uniform point of the unit disk, lifted to the hemisphere, has the density
// cos θ / π. The disk is filled by Shirley and Chiu's concentric map, which turns squares into rings of equal area.
vec2 sample_disk_concentric(vec2 u) {
    vec2 square = 2.0 * u - 1.0;  // in [-1,1)²
    if (square == vec2(0.0)) return vec2(0.0);
    float radius, angle;
    if (abs(square.x) > abs(square.y)) {
        radius = square.x;
        angle = 0.25 * PI * (square.y / square.x);
    } else {
        radius = square.y;
        angle = 0.5 * PI - 0.25 * PI * (square.x / square.y);
    }
    return radius * vec2(cos(angle), sin(angle));
}

vec3 sample_cosine_hemisphere(vec2 u) {
    vec2 disk = sample_disk_concentric(u);
    return vec3(disk, sqrt(max(1.0 - dot(disk, disk), 0.0)));
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 L = vec3(0.0), beta = vec3(1.0);
    for (uint bounce = 0u; bounce <= parameters.max_path_length; ++bounce) {
        Hit hit;
        bool is_hit = trace_ray(ray, NO_LIMIT, hit);
        if (!is_hit && is_counted(bounce)) L += beta * get_background_radiance(ray.direction);
        if (!is_hit) break;

        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(bounce)) L += beta * s.emission;

        vec3 wo = -ray.direction;
        vec3 wi = get_shading_space(s.normal) * sample_cosine_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, wo) || !is_above_surface(s, wi)) break;
        // f cos θ / p with p = cos θ / π: the cosine cancels, and what is left is π f.
        beta *= get_pi_brdf(s, wi, wo);
        ray = get_ray_from_surface(s, wi);
    }
    return L;
}
