// The density of sample_lobes() with respect to solid angle, for a direction above the surface.
float get_lobes_density(ShadingData s, vec3 in_direction) {
    float cosine_part = dot(s.normal, in_direction) / PI;
#ifdef FEATURE_SPECULAR
    float share = get_phong_probability(s);
    cosine_part *= 1.0 - share;
    if (share > 0.0) cosine_part += share * get_phong_density(s, in_direction);
#endif
    return cosine_part;
}

// Samples ω_k. One pair of numbers is enough: what is left of the first after the choice of a lobe is uniform again.
BsdfSample sample_lobes(ShadingData s, inout uvec2 seed) {
    vec2 u = get_random_numbers(seed);
    float share = 0.0;
#ifdef FEATURE_SPECULAR
    share = get_phong_probability(s);
    if (u.y < share) {
        vec3 mirrored = sample_phong(s, vec2(u.x, min(u.y / share, 0.99999994)));
        float p = get_lobes_density(s, mirrored);
        if (!is_above_surface(s, mirrored)) return BsdfSample(mirrored, vec3(0.0), p, 1.0);
        return BsdfSample(mirrored, get_brdf(s, mirrored) * dot(s.normal, mirrored) / p, p, 1.0);
    }
#endif
    // sample_hemisphere() takes the azimuth from the first number and the inclination from the second.
    vec3 omega = get_shading_space(s.normal) * sample_hemisphere(vec2(u.x, min((u.y - share) / (1.0 - share), 0.99999994)));
    if (!is_above_surface(s, omega)) return BsdfSample(omega, vec3(0.0), 1.0, 1.0);
    float p = get_lobes_density(s, omega);
    return BsdfSample(omega, get_brdf(s, omega) * dot(s.normal, omega) / p, p, 1.0);
}
