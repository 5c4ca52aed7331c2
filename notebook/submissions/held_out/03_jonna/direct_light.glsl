// Estimates the direct light that x_k reflects along ω_o, from one point y on the lights.
vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    // Choose a triangle with probability P, proportional to its area A times the luminance of its emission, and a uniform point y
    // on it. The square root makes up for the triangle's narrowing towards its first vertex. The density of y is P/A with respect
    // to area.
    LightTriangle light = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));

    // The cosine at the light.
    vec3 to_light = y.position - s.position;
    float distance = length(to_light);
    vec3 omega = to_light / distance;
    float cos_light = abs(dot(y.normal, omega));
    if (cos_light == 0.0 || !is_above_surface(s, omega)) return vec3(0.0);

    // V: a shadow ray that ends just short of the light.
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);

    // The weight ρ n·ω cos θ' / r² A/P.
    float geometry = dot(s.normal, omega) * cos_light / (distance * distance);
    return get_brdf(s, omega) * geometry * light.inverse_density * y.emission;
}
