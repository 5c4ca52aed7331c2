// Weights by Veach's power heuristic with the exponent 2, everywhere.

// dA -> dω
float to_solid_angle(float area_density, float distance, float cos_light) {
    return area_density * distance * distance / cos_light;
}

// a² / (a² + b²), written with the ratio so that squares of large densities do not overflow.
float power_heuristic(float a, float b) {
    if (a <= 0.0) return 0.0;
    float ratio = b / a;
    return 1.0 / (1.0 + ratio * ratio);
}

// Weight of a bounce that finds light. Without a light sample that could do so it takes all.
float get_bounce_part(float light_density, float bounce_density) {
    if (light_density <= 0.0) return 1.0;
    return power_heuristic(bounce_density, light_density);
}

// Weight of a light sample, times ρ cos / p_l.
vec3 get_light_sample_weight(ShadingData s, vec3 omega, float light_density) {
    float w = 1.0;
    if (STRATEGY != STRATEGY_LIGHT) w = power_heuristic(light_density, get_bsdf_density(s, omega));
    return w * get_brdf(s, omega) * dot(s.normal, omega) / light_density;
}

vec3 sample_light_triangle(ShadingData s, inout uvec2 seed) {
    vec2 u;
    LightTriangle light = choose_light_triangle(seed, u);
    float r = sqrt(u.x);
    LightPoint y = get_light_point(light, r * vec2(1.0 - u.y, u.y));

    vec3 to_light = y.position - s.position;
    float distance = length(to_light);
    vec3 omega = to_light / distance;
    float cos_light = dot(y.normal, -omega);
    if (!(cos_light > 0.0) || !is_above_surface(s, omega)) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);

    float light_density = to_solid_angle(y.light_density, distance, cos_light);
    return get_light_sample_weight(s, omega, light_density) * y.emission * (light.inverse_density * y.light_density);
}
