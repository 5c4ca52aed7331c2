// Fresnel's reflectance by the textbook: r_s and r_p from the cosines and indices of both sides. `eta_cos_theta_t` is the index times the
// cosine of the refracted direction.
float get_fresnel_reflectance(float cos_theta, float eta, float eta_cos_theta_t) {
    if (eta == 1.0) return 0.0;
    float cos_t = eta_cos_theta_t / eta;
    float perpendicular = (cos_theta - eta * cos_t) / (cos_theta + eta * cos_t);
    float parallel = (eta * cos_theta - cos_t) / (eta * cos_theta + cos_t);
    return mix(perpendicular * perpendicular, parallel * parallel, 0.5);
}

// Refracts with the sines: what is along the surface shrinks by 1/eta.
vec3 refract_direction(vec3 n, vec3 out_direction, float cos_theta, float eta, float cos_t) {
    return normalize((cos_theta * n - out_direction) / eta - cos_t * n);
}

BsdfSample sample_dielectric(ShadingData s, inout uvec2 seed) {
    float c = dot(s.normal, s.out_direction), eta = s.relative_index;
    float sin2_t = (1.0 - c * c) / (eta * eta);
    float F = 1.0;
    float cos_t = 0.0;
    if (sin2_t < 1.0) {
        cos_t = sqrt(1.0 - sin2_t);
        F = get_fresnel_reflectance(c, eta, eta * cos_t);
    }
    // Transmission is decided with 1 - F, and not reflection with F.
    if (sin2_t < 1.0 && happens(1.0 - F, seed)) {
        vec3 omega = refract_direction(s.normal, s.out_direction, c, eta, cos_t);
        vec3 weight = dot(s.geometric_normal, omega) > 0.0 ? vec3(0.0) : vec3(1.0);
        return BsdfSample(omega, weight, 0.0, 1.0 / (eta * eta));
    }
    vec3 mirrored = reflect(-s.out_direction, s.normal);
    return BsdfSample(mirrored, vec3(dot(s.geometric_normal, mirrored) > 0.0), 0.0, 1.0);
}
