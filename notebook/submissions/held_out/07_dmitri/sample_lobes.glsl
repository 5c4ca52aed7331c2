// A mixture of the cosine and the Phong lobe.
float get_lobes_density(ShadingData s, vec3 in_direction) {
    float diffuse = dot(s.normal, in_direction) / PI;
#ifdef FEATURE_SPECULAR
    float p = get_phong_probability(s);
    return (1.0 - p) * diffuse + p * get_phong_density(s, in_direction);
#else
    return diffuse;
#endif
}

BsdfSample sample_lobes(ShadingData s, inout uvec2 seed) {
    vec3 omega;
    float density;
#ifdef FEATURE_SPECULAR
    if (happens(get_phong_probability(s), seed)) {
        omega = sample_phong(s, get_random_numbers(seed));
        density = get_phong_density(s, omega);
    } else {
        omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        density = dot(s.normal, omega) / PI;
    }
#else
    omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
    density = dot(s.normal, omega) / PI;
#endif
    if (!is_above_surface(s, omega)) return BsdfSample(omega, vec3(0.0), density, 1.0);
    vec3 weight = get_brdf(s, omega) * dot(s.normal, omega) / get_lobes_density(s, omega);
    return BsdfSample(omega, weight, density, 1.0);
}
