// Estimates the direct light that x_k reflects along ω_o, by one point y on the lights.
vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    LightTriangle light = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));

    vec3 to_light = y.position - s.position;
    float distance = length(to_light);
    vec3 omega = to_light / distance;

    // cosines at both ends
    float cos_surface = dot(s.normal, omega);
    float cos_light = dot(y.normal, -omega);
    if (cos_light <= 0.0) return vec3(0.0);
    if (!is_above_surface(s, omega)) return vec3(0.0);

    // shadow ray
    Ray shadow_ray = get_ray_from_surface(s, omega);
    if (is_occluded(shadow_ray, 1.0)) return vec3(0.0);

    vec3 weight = get_brdf(s, omega) * cos_surface * cos_light / (distance * distance);
    return weight * light.inverse_density * y.emission;
}
