// The Fresnel reflectance F for unpolarised light. Here cos θ > 0 is that of the incident direction, η the refractive index beyond the
// surface over that before it, and η cos θ_t that of the refracted direction, by Snell's law (η cos θ_t)² = η² - 1 + cos² θ. Both
// numerators have η² - 1 as a factor, so nothing cancels where η is close to 1.
float get_fresnel_reflectance(float cos_theta, float eta, float eta_cos_theta_t) {
    float contrast = (eta - 1.0) * (eta + 1.0);
    if (contrast == 0.0) return 0.0;
    float sum_s = cos_theta + eta_cos_theta_t;
    float sum_p = eta * eta * cos_theta + eta_cos_theta_t;
    float r_s = -contrast / (sum_s * sum_s);
    float r_p = contrast * ((eta * eta + 1.0) * cos_theta * cos_theta - 1.0) / (sum_p * sum_p);
    // Unpolarised light: the mean amplitude of both polarisations, squared.
    float amplitude = 0.5 * (r_s + r_p);
    return amplitude * amplitude;
}

// Follows either the reflected direction, with probability F, or the refracted one. So the weight is 1.
BsdfSample sample_dielectric(ShadingData s, inout uvec2 seed) {
    float cos_theta = dot(s.normal, s.out_direction);
    float eta = s.relative_index;
    float contrast = (eta - 1.0) * (eta + 1.0);
    float square = contrast + cos_theta * cos_theta;
    // Without a refracted direction all light is reflected: total internal reflection.
    float eta_cos_theta_t = sqrt(max(square, 0.0));
    bool is_reflected = square <= 0.0 || happens(get_fresnel_reflectance(cos_theta, eta, eta_cos_theta_t), seed);

    vec3 omega = 2.0 * cos_theta * s.normal - s.out_direction;
    if (!is_reflected) {
        // cos θ - η cos θ_t, again without cancellation.
        float difference = -contrast / (cos_theta + eta_cos_theta_t);
        omega = normalize(difference * s.normal - s.out_direction);
    }
    // A direction on different sides of the shading and the geometric normal carries no light.
    vec3 weight = vec3(is_reflected == (dot(s.geometric_normal, omega) > 0.0));
    return BsdfSample(omega, weight, 0.0, is_reflected ? 1.0 : 1.0 / (eta * eta));
}
