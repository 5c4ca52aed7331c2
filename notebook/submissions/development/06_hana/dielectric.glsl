// My solution for chapter 6. Reflection gets at least a tenth of the samples, so that the faint mirror images are not noisy.

float get_fresnel_reflectance(float cos_theta, float eta, float eta_cos_theta_t) {
    float a = cos_theta, b = eta_cos_theta_t;
    float s_polarised = (a - b) / (a + b);
    float p_polarised = (eta * eta * a - b) / (eta * eta * a + b);
    return 0.5 * s_polarised * s_polarised + 0.5 * p_polarised * p_polarised;
}

BsdfSample sample_dielectric(ShadingData s, inout uvec2 seed) {
    float eta = s.relative_index;
    float c = dot(s.normal, s.out_direction);
    float k = eta * eta - 1.0 + c * c;  // (eta cos theta_t)^2
    float ect = sqrt(max(k, 0.0));

    float F = 1.0;
    if (k > 0.0) F = clamp(get_fresnel_reflectance(c, eta, ect), 0.1, 0.9);
    bool reflects = happens(F, seed);

    // The probability of either direction is its share of the light, so they cancel and the weight is 1.
    BsdfSample result;
    result.density = 0.0;
    if (reflects) {
        result.direction = 2.0 * c * s.normal - s.out_direction;
        result.weight = vec3(dot(s.geometric_normal, result.direction) > 0.0);
        result.radiance_scale = 1.0;
    } else {
        result.direction = normalize((c - ect) * s.normal - s.out_direction);
        result.weight = vec3(!(dot(s.geometric_normal, result.direction) > 0.0));
        result.radiance_scale = 1.0 / (eta * eta);
    }
    return result;
}
