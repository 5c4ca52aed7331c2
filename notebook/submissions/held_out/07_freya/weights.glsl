// Weights that divide the light between light samples and bounces, and light samples that use them.

// Turns a density with respect to area into one with respect to solid angle: dω = cos θ' / r² dA.
float to_solid_angle(float area_density, float distance, float cos_light) {
    return area_density * distance * distance / cos_light;
}

// The part of what a bounce finds that counts: p_b² / (p_l² + p_b²), or all of it where light samples find nothing.
float get_bounce_part(float light_density, float bounce_density) {
    // The power heuristic with exponent 2, as a function of the quotient, which does not overflow.
    if (light_density == 0.0) return 1.0;
    if (bounce_density == 0.0) return 0.0;
    float quotient = light_density / bounce_density;
    return 1.0 / (1.0 + quotient * quotient);
}

// The factor of what a light sample finds: ρ n·ω / p_l · p_l² / (p_l² + p_b²).
vec3 get_light_sample_weight(ShadingData s, vec3 omega, float light_density) {
    float bounce_density = STRATEGY == STRATEGY_LIGHT ? 0.0 : get_bsdf_density(s, omega);
    float quotient = bounce_density / light_density;
    return get_brdf(s, omega) * (dot(s.normal, omega) / (light_density * (1.0 + quotient * quotient)));
}

// Estimates the direct light that x_k reflects along ω_o from one point y on the lights, weighted against bounces.
vec3 sample_light_triangle(ShadingData s, inout uvec2 seed) {
    // A uniform point on a triangle chosen with probability P: density P/A with respect to area.
    vec2 u;
    LightTriangle light = choose_light(s, seed, u);
    LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));

    // Both cosines must be positive. Lights emit from the front only.
    vec3 to_light = y.position - s.position;
    float distance = length(to_light);
    vec3 omega = to_light / distance;
    float cos_light = dot(y.normal, -omega);
    if (!(cos_light > 0.0) || !is_above_surface(s, omega)) return vec3(0.0);

    // V: a shadow ray that ends just short of the light.
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);

    // The last factor is 1, up to the rounding of P in the alias table.
    float light_density = to_solid_angle(y.light_density, distance, cos_light);
    return get_light_sample_weight(s, omega, light_density) * y.emission * (light.inverse_density * y.light_density);
}
