// Dielectric by Emil: the textbook's Fresnel equations with angles on both sides, and GLSL's refract() for Snell's law.

// eta = n2 / n1, where the light that we follow backwards comes along a ray in medium 1.
float get_fresnel_reflectance(float cos_theta, float eta, float eta_cos_theta_t) {
    float n1 = 1.0;
    float n2 = eta;
    float cos1 = cos_theta;
    float cos2 = eta_cos_theta_t / eta;
    float rs = (n1 * cos1 - n2 * cos2) / (n1 * cos1 + n2 * cos2);
    float rp = (n2 * cos1 - n1 * cos2) / (n2 * cos1 + n1 * cos2);
    return (rs * rs + rp * rp) / 2.0;
}

BsdfSample sample_dielectric(ShadingData s, inout uvec2 seed) {
    vec3 incoming = -s.out_direction;
    vec3 n = s.normal;
    float n1_over_n2 = 1.0 / s.relative_index;
    float cos1 = dot(n, s.out_direction);
    vec3 reflected = reflect(incoming, n);
    vec3 refracted = refract(incoming, n, n1_over_n2);

    BsdfSample result;
    result.density = 0.0;

    // refract() returns 0 for total internal reflection
    float F = 1.0;
    if (refracted != vec3(0.0)) {
        float cos2 = -dot(n, refracted);
        F = get_fresnel_reflectance(cos1, s.relative_index, s.relative_index * cos2);
    }
    if (happens(F, seed)) {
        result.direction = reflected;
        result.weight = dot(s.geometric_normal, reflected) > 0.0 ? vec3(1.0) : vec3(0.0);
        result.radiance_scale = 1.0;
    } else {
        result.direction = normalize(refracted);
        result.weight = dot(s.geometric_normal, refracted) > 0.0 ? vec3(0.0) : vec3(1.0);
        result.radiance_scale = n1_over_n2 * n1_over_n2;
    }
    return result;
}
