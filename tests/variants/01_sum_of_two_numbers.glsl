// Uniform azimuth, but an inclination that avoids the pole and the horizon, where sin θ cos θ is small: θ = π/4 t,
// where t in [0,2) is the sum of two uniform numbers. Its density is the tent p(t) = t up to 1 and 2 - t from there.
//
// p(θ, φ) = p(t) · 4/π · 1/(2π) and dω = sin θ dθ dφ, so 1/p(ω) = π²/2 sin θ / p(t). At both ends cos θ sin θ and p(t)
// go to 0 together, and the weight stays below 1.3 times the albedo.
float get_tent(float t) { return t < 1.0 ? t : 2.0 - t; }

vec3 get_direction(float inclination, float azimuth) {
    float height = cos(inclination), radius = sin(inclination);
    return vec3(radius * cos(azimuth), radius * sin(azimuth), height);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    uint length_now = 0u;
    Hit hit;
    do {
        vec3 view = -ray.direction;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            vec3 sky = get_background_radiance(ray.direction);
            return is_counted(length_now) ? radiance + throughput * sky : radiance;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(length_now)) radiance += throughput * s.emission;
        if (!is_above_surface(s, view)) break;

        vec2 u = get_random_numbers(seed);
        float t = u.x + u.y;
        if (t == 0.0) break;  // once in 2^48
        float theta = 0.25 * PI * t;
        vec3 direction = get_shading_space(s.normal) * get_direction(theta, 2.0 * PI * get_random_numbers(seed).x);
        if (!is_above_surface(s, direction)) break;
        // One factor after the other: reflectance, cosine, one over the density.
        throughput *= get_pi_brdf(s, direction, view) / PI;
        throughput *= cos(theta);
        throughput *= 0.5 * PI * PI * sin(theta) / get_tent(t);
        ray = get_ray_from_surface(s, direction);
    } while (length_now++ < parameters.max_path_length);
    return radiance;
}
