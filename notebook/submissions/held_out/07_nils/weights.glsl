// Weights by which light samples and bounces share the light, and light samples that use them.

// Turns a density with respect to area into one with respect to solid angle: dω = cos θ' / r² dA.
float to_solid_angle(float area_density, float distance, float cos_light) {
    return area_density * distance * distance / cos_light;
}

// Veach's power heuristic with exponent 2, of a density against another one: p² / (p² + q²). Written with the ratio q/p,
// because the squares of large densities would overflow.
float power_heuristic(float p, float q) {
    float ratio = q / p;
    return 1.0 / (1.0 + ratio * ratio);
}

// w_b. Where light samples find nothing, the bounce has it all.
float get_bounce_part(float light_density, float bounce_density) {
    if (light_density <= 0.0) return 1.0;
    if (bounce_density <= 0.0) return 0.0;
    return power_heuristic(bounce_density, light_density);
}

// w_l times the estimator f cos / p_l.
vec3 get_light_sample_weight(ShadingData s, vec3 omega, float light_density) {
    float p_b = STRATEGY == STRATEGY_LIGHT ? 0.0 : get_bsdf_density(s, omega);
    float w_l = power_heuristic(light_density, p_b);
    vec3 f_cos = get_brdf(s, omega) * dot(s.normal, omega);
    return f_cos * (w_l / light_density);
}

// The direct light that x_k reflects along ω_o, as far as it is left to one point y on the lights.
vec3 sample_light_triangle(ShadingData s, inout uvec2 seed) {
    // A uniform point on a triangle that is chosen with probability P: density P/A with respect to area.
    vec2 u;
    LightTriangle light = choose_light_triangle(seed, u);
    LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));

    // Both cosines must be positive. Lights emit from the front only.
    vec3 to_light = y.position - s.position;
    float distance = length(to_light);
    vec3 omega = to_light / distance;
    float cos_light = dot(y.normal, -omega);
    if (!(cos_light > 0.0) || !is_above_surface(s, omega)) return vec3(0.0);

    // V: a shadow ray that ends just short of the light.
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);

    // The last factor is 1, but for the rounding of P in the alias table.
    float light_density = to_solid_angle(y.light_density, distance, cos_light);
    return get_light_sample_weight(s, omega, light_density) * y.emission * (light.inverse_density * y.light_density);
}
