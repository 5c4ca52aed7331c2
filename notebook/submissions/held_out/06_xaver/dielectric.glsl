// Schlick's approximation.
float schlick(float cosine, float ratio) {
    float r0 = (1.0 - ratio) / (1.0 + ratio);
    r0 = r0 * r0;
    return r0 + (1.0 - r0) * pow(1.0 - cosine, 5.0);
}

float get_fresnel_reflectance(float cos_theta, float eta, float eta_cos_theta_t) {
    if (eta == 1.0) return 0.0;
    return schlick(cos_theta, eta);
}

// Reflects or refracts, by chance.
BsdfSample sample_dielectric(ShadingData s, inout uvec2 seed) {
    float eta = s.relative_index;
    float c = dot(s.normal, s.out_direction);
    float g2 = eta * eta - 1.0 + c * c;
    float g = sqrt(max(g2, 0.0));
    bool reflects = g2 <= 0.0 || happens(get_fresnel_reflectance(c, eta, g), seed);

    BsdfSample result;
    result.density = 0.0;
    if (reflects) {
        result.direction = 2.0 * c * s.normal - s.out_direction;
        result.radiance_scale = 1.0;
    } else {
        result.direction = normalize((c - g) * s.normal - s.out_direction);
        result.radiance_scale = 1.0 / (eta * eta);
    }
    result.weight = vec3(reflects == (dot(s.geometric_normal, result.direction) > 0.0));
    return result;
}
