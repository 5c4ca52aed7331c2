// What chapter 6 teaches, for the chapters after it.

// The Fresnel reflectance for unpolarised light. cos θ > 0 belongs to the incident direction, η is the refractive index
// beyond the surface over that before it, η cos θ_t belongs to the refracted direction, with Snell's law
// (η cos θ_t)² = η² - 1 + cos² θ. Both numerators hold η² - 1 as a factor: nothing cancels where η is close to 1.
float get_fresnel_reflectance(float cos_theta, float eta, float eta_cos_theta_t) {
    float contrast = (eta - 1.0) * (eta + 1.0);
    if (contrast == 0.0) return 0.0;
    float sum_s = cos_theta + eta_cos_theta_t;
    float sum_p = eta * eta * cos_theta + eta_cos_theta_t;
    float r_s = -contrast / (sum_s * sum_s);
    float r_p = contrast * ((eta * eta + 1.0) * cos_theta * cos_theta - 1.0) / (sum_p * sum_p);
    return 0.5 * (r_s * r_s + r_p * r_p);
}

// The direction ω_k behind or before a smooth dielectric, reflected with probability F.
vec3 sample_dielectric(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    float cos_theta = dot(s.normal, out_direction);
    float eta = s.relative_index;
    float contrast = (eta - 1.0) * (eta + 1.0);
    float square = contrast + cos_theta * cos_theta;
    // Without a refracted direction all light is reflected: total internal reflection.
    float eta_cos_theta_t = sqrt(max(square, 0.0));
    if (square <= 0.0 || happens(get_fresnel_reflectance(cos_theta, eta, eta_cos_theta_t), seed))
        return 2.0 * cos_theta * s.normal - out_direction;
    // cos θ - η cos θ_t, once more without cancellation.
    float difference = -contrast / (cos_theta + eta_cos_theta_t);
    return normalize(difference * s.normal - out_direction);
}
