// Directions that follow the lobes of an opaque surface: a mixture of the cosine and the Phong lobe, chosen by their shares of the albedo.

// The density of sample_lobes() with respect to solid angle, for a direction above the surface.
float get_lobes_density(ShadingData s, vec3 in_direction) {
    float density = dot(s.normal, in_direction) / PI;
#ifdef FEATURE_SPECULAR
    density = mix(density, get_phong_density(s, in_direction), get_phong_probability(s));
#endif
    return density;
}

// Samples ω_k with the density get_lobes_density().
BsdfSample sample_lobes(ShadingData s, inout uvec2 seed) {
    bool is_from_lobe = false;
    vec3 omega;
#ifdef FEATURE_SPECULAR
    is_from_lobe = happens(get_phong_probability(s), seed);
    if (is_from_lobe) omega = sample_phong(s, get_random_numbers(seed));
#endif
    if (!is_from_lobe) omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
    // The weight ρ n·ω / p_b = π ρ · (n·ω / π) / p_b: exactly π ρ where p_b is the cosine's density.
    float density = get_lobes_density(s, omega);
    vec3 weight = PI * get_brdf(s, omega) * (dot(s.normal, omega) / PI / density);
    return BsdfSample(omega, is_above_surface(s, omega) ? weight : vec3(0.0), density, 1.0);
}
