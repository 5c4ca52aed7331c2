// Samples ω_k: at a dielectric one of two directions, elsewhere with density n·ω_k / π with respect to solid angle and the
// weight π ρ.
BsdfSample sample_bsdf(ShadingData s, inout uvec2 seed) {
    if (s.is_dielectric) return sample_dielectric(s, seed);
    vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
    vec3 weight = is_above_surface(s, omega) ? PI * get_brdf(s, omega) : vec3(0.0);
    return BsdfSample(omega, weight, dot(s.normal, omega) / PI, 1.0);
}
