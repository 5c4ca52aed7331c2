// Carlos: one pair of random numbers for the choice of the part and for the direction. What the choice leaves of u.x is stretched to
// [0, 1) again and is as good as new.

float diffuse_pdf(ShadingData s, vec3 wi) { return dot(s.normal, wi) * (1.0 / PI); }

float get_bsdf_density(ShadingData s, vec3 in_direction) {
    float pdf = diffuse_pdf(s, in_direction);
#ifdef FEATURE_SPECULAR
    float glossy = get_phong_probability(s);
    pdf = glossy * get_phong_density(s, in_direction) + (1.0 - glossy) * pdf;
#endif
    return pdf;
}

BsdfSample sample_bsdf(ShadingData s, inout uvec2 seed) {
    if (s.is_dielectric) return sample_dielectric(s, seed);

    const float below_one = 0.99999994;
    vec2 u = get_random_numbers(seed);
    vec3 wi;
#ifdef FEATURE_SPECULAR
    float glossy = get_phong_probability(s);
    if (u.x < glossy) {
        u.x = min(u.x / glossy, below_one);
        wi = sample_phong(s, u);
    } else {
        u.x = min((u.x - glossy) / (1.0 - glossy), below_one);
        wi = get_shading_space(s.normal) * sample_hemisphere(u);
    }
#else
    wi = get_shading_space(s.normal) * sample_hemisphere(u);
#endif

    BsdfSample result = BsdfSample(wi, vec3(0.0), get_bsdf_density(s, wi), 1.0);
    if (is_above_surface(s, wi)) result.weight = get_brdf(s, wi) * (dot(s.normal, wi) / result.density);
    return result;
}
