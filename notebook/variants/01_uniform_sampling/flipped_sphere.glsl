// Uniform directions: a uniform point on the whole unit sphere (Archimedes: its height is uniform), mirrored to the
// side of the normal. No frame is needed. Density 1/(2π) with respect to solid angle.
vec3 sample_sphere(vec2 u) {
    float height = 1.0 - 2.0 * u.x;
    float radius = sqrt(max(1.0 - height * height, 0.0));
    float azimuth = 2.0 * PI * u.y;
    return vec3(radius * sin(azimuth), height, radius * cos(azimuth));
}

vec3 sample_side_of(vec3 normal, vec2 u) {
    vec3 direction = sample_sphere(u);
    return dot(direction, normal) < 0.0 ? -direction : direction;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    const float density = 1.0 / (2.0 * PI);
    vec3 result = vec3(0.0);
    vec3 weight = vec3(1.0);
    uint bounces_left = parameters.max_path_length;
    bool is_alive = true;
    while (is_alive) {
        is_alive = false;
        uint bounces = parameters.max_path_length - bounces_left;
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(bounces)) result += weight * get_background_radiance(ray.direction);
            continue;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(bounces)) result += weight * s.emission;
        if (bounces_left == 0u) continue;

        vec3 incoming = sample_side_of(s.normal, get_random_numbers(seed));
        vec3 outgoing = -ray.direction;
        if (is_above_surface(s, incoming) && is_above_surface(s, outgoing)) {
            // brdf · cosine / density
            vec3 brdf = get_brdf(s, incoming);
            weight *= brdf * dot(s.normal, incoming) / density;
            ray = get_ray_from_surface(s, incoming);
            --bounces_left;
            is_alive = true;
        }
    }
    return result;
}
