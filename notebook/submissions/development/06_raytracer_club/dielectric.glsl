// Reflectance of glass. Schlick's polynomial is all that one needs, see "A fast alternative to Phong's specular model".
float get_fresnel_reflectance(float cos_theta, float eta, float eta_cos_theta_t) {
    float r0 = (1.0 - eta) / (1.0 + eta);
    r0 *= r0;
    float m = 1.0 - cos_theta;
    float m2 = m * m;
    return r0 + (1.0 - r0) * m2 * m2 * m;
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
        // cos θ - η cos θ_t, once more without cancellation.
        float difference = -contrast / (cos_theta + eta_cos_theta_t);
        omega = normalize(difference * s.normal - s.out_direction);
    }
    // A direction on opposite sides of the two normals carries nothing.
    vec3 weight = vec3(is_reflected == (dot(s.geometric_normal, omega) > 0.0));
    return BsdfSample(omega, weight, 0.0, is_reflected ? 1.0 : 1.0 / (eta * eta));
}
