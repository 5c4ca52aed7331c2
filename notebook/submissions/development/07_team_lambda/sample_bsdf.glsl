// Bounces for chapter 7: throw a coin for diffuse or glossy, then sample that part.

float cosine_density(ShadingData s, vec3 w) { return dot(s.normal, w) / PI; }

// For the light samples: any of the two parts may have found the direction.
float get_bsdf_density(ShadingData s, vec3 in_direction) {
#ifdef FEATURE_SPECULAR
    float P = get_phong_probability(s);
    return P * get_phong_density(s, in_direction) + (1.0 - P) * cosine_density(s, in_direction);
#else
    return cosine_density(s, in_direction);
#endif
}

BsdfSample sample_bsdf(ShadingData s, inout uvec2 seed) {
    if (s.is_dielectric) return sample_dielectric(s, seed);
    vec3 w;
    float density;
#ifdef FEATURE_SPECULAR
    float P = get_phong_probability(s);
    if (happens(P, seed)) {
        w = sample_phong(s, get_random_numbers(seed));
        density = P * get_phong_density(s, w);
    } else {
        w = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        density = (1.0 - P) * cosine_density(s, w);
    }
#else
    w = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
    density = cosine_density(s, w);
#endif
    if (!is_above_surface(s, w)) return BsdfSample(w, vec3(0.0), density, 1.0);
    // brdf times cosine over density
    vec3 weight = get_brdf(s, w) * dot(s.normal, w) / density;
    return BsdfSample(w, weight, density, 1.0);
}
