// The factor of a bounce is written with the double angle: pi^2 cos(theta) sin(theta) = pi^2/2 sin(2 theta).
vec3 sample_angles(ShadingData s, vec2 u, out float factor) {
    float azimuth = 2.0 * PI * u.y;
    float inclination = 0.5 * PI * u.x;
    factor = 0.5 * PI * PI * sin(2.0 * inclination);
    mat3 frame = get_shading_space(s.normal);
    return sin(inclination) * (cos(azimuth) * frame[0] + sin(azimuth) * frame[1]) + cos(inclination) * frame[2];
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 sum = vec3(0.0), weight = vec3(1.0);
    uint length_so_far = 0u;
    bool goes_on = true;
    while (goes_on) {
        Hit hit;
        vec3 found;
        if (trace_ray(ray, NO_LIMIT, hit)) {
            ShadingData s = get_shading_data(hit, ray.direction);
            found = weight * s.emission;
            goes_on = length_so_far < parameters.max_path_length && is_above_surface(s, s.out_direction);
            if (goes_on) {
                float factor;
                vec3 omega = sample_angles(s, get_random_numbers(seed), factor);
                goes_on = is_above_surface(s, omega);
                weight *= factor * get_brdf(s, omega);
                ray = get_ray_from_surface(s, omega);
            }
        } else {
            found = weight * get_background_radiance(ray.direction);
            goes_on = false;
        }
        if (is_counted(length_so_far)) sum += found;
        ++length_so_far;
    }
    return sum;
}
