// Uniform angles without a sine or cosine of the azimuth: points of a square until one lies in the unit disk; the
// direction from the centre to it is uniform on the circle. The inclination is uniform as before.
vec2 sample_circle(inout uvec2 seed) {
    vec2 point;
    float square;
    do {
        point = 2.0 * get_random_numbers(seed) - 1.0;
        square = dot(point, point);
    } while (square > 1.0 || square < 1e-8);
    return point / sqrt(square);
}

// What a vertex of the path does with light: which direction it asks, and what that radiance counts. Zero where
// nothing is scattered.
struct Scattering {
    vec3 direction;
    vec3 factor;
};

Scattering scatter(ShadingData s, vec3 to_eye, inout uvec2 seed) {
    vec2 circle = sample_circle(seed);
    float theta = get_random_numbers(seed).x * PI / 2.0;
    float sine = sin(theta);
    vec3 direction = get_shading_space(s.normal) * vec3(circle * sine, cos(theta));
    if (!is_above_surface(s, to_eye) || !is_above_surface(s, direction)) return Scattering(direction, vec3(0.0));
    // ρ cos θ over the density 1/(π² sin θ), with πρ from the materials
    float cosine = dot(direction, s.normal);
    float inverse_density_over_pi = PI * sine;
    return Scattering(direction, get_pi_brdf(s, direction, to_eye) * cosine * inverse_density_over_pi);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0), throughput = vec3(1.0);
    Hit hit;
    uint depth = 0u;
    while (trace_ray(ray, NO_LIMIT, hit)) {
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(depth)) radiance += throughput * s.emission;
        if (depth >= parameters.max_path_length) return radiance;
        Scattering scattering = scatter(s, -ray.direction, seed);
        if (scattering.factor == vec3(0.0)) return radiance;
        throughput *= scattering.factor;
        ray = get_ray_from_surface(s, scattering.direction);
        ++depth;
    }
    // The path has left the scene.
    if (is_counted(depth)) radiance += throughput * get_background_radiance(ray.direction);
    return radiance;
}
