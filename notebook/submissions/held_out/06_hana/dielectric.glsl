// Fresnel's equations as they stand in optics books, with n_1 = 1 before the surface and n_2 = eta beyond it:
//     R_s = |(n_1 cos i - n_2 cos t) / (n_1 cos i + n_2 cos t)|²
//     R_p = |(n_1 cos t - n_2 cos i) / (n_1 cos t + n_2 cos i)|²
// Unpolarised light: the mean of both.
float get_fresnel_reflectance(float cos_i, float eta, float eta_cos_t) {
    float cos_t = eta_cos_t / eta;
    float r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    float r_p = (cos_t - eta * cos_i) / (cos_t + eta * cos_i);
    return (r_s * r_s + r_p * r_p) / 2.0;
}

BsdfSample sample_dielectric(ShadingData s, inout uvec2 seed) {
    vec3 view = s.out_direction;
    float eta = s.relative_index;
    float cos_i = dot(s.normal, view);

    // Snell: sin t = sin i / eta. If this is 1 or more, there is no refracted direction.
    float sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    float F = 1.0;
    if (sin2_t < 1.0) F = get_fresnel_reflectance(cos_i, eta, eta * sqrt(1.0 - sin2_t));

    if (happens(F, seed)) {
        vec3 mirrored = reflect(-view, s.normal);
        bool is_valid = dot(s.geometric_normal, mirrored) > 0.0;
        return BsdfSample(mirrored, vec3(is_valid ? 1.0 : 0.0), 0.0, 1.0);
    }
    vec3 refracted = normalize(refract(-view, s.normal, 1.0 / eta));
    bool is_valid = dot(s.geometric_normal, refracted) <= 0.0;
    return BsdfSample(refracted, vec3(is_valid ? 1.0 : 0.0), 0.0, 1.0 / (eta * eta));
}
