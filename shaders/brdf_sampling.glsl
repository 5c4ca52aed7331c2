// Directions with about the density of the whole BRDF: a mixture of the cosine and the Phong lobe.
#include "sampling.glsl"

#ifdef FEATURE_SPECULAR
// The probability P of choosing the lobe: its share of the albedo.
float get_lobe_probability(ShadingData s) {
    float specular = max_component(s.specular_albedo);
    return specular > 0.0 ? specular / (max_component(s.diffuse_albedo) + specular) : 0.0;
}

// 1 - e^x for x <= 0. The difference would cancel where x is close to 0.
float get_one_minus_exp(float x) {
    if (x < -0.125) return 1.0 - exp(x);
    return -x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0 * (1.0 + x / 5.0))));
}

// Direction about the z-axis with density (n+1) / (2π) cos^n α with respect to solid angle, where n is the exponent.
// u_x = cos^(n+1) α; from here on 1 - cos α is exact even where α is small.
vec3 sample_lobe(float exponent, vec2 u) {
    float one_minus_cos = get_one_minus_exp(log(1.0 - u.x) / (exponent + 1.0));
    float sin_alpha = sqrt(one_minus_cos * (2.0 - one_minus_cos));
    float phi = 2.0 * PI * u.y;
    return vec3(cos(phi) * sin_alpha, sin(phi) * sin_alpha, 1.0 - one_minus_cos);
}
#endif

// The density of sample_brdf() with respect to solid angle, for a direction above the surface.
float get_brdf_density(ShadingData s, vec3 in_direction, vec3 out_direction) {
    float density = dot(s.normal, in_direction) / PI;
#ifdef FEATURE_SPECULAR
    float lobe = (s.specular_exponent + 1.0) / (2.0 * PI) * get_lobe(s, in_direction, out_direction);
    density = mix(density, lobe, get_lobe_probability(s));
#endif
    return density;
}

// The direction of a bounce, as unit vector. It may point below the surface, where it carries nothing.
vec3 sample_brdf(ShadingData s, vec3 out_direction, inout uvec2 seed) {
#ifdef FEATURE_SPECULAR
    if (happens(get_lobe_probability(s), seed))
        return get_shading_space(reflect(-out_direction, s.normal)) *
               sample_lobe(s.specular_exponent, get_random_numbers(seed));
#endif
    return get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
}
