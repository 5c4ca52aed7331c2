// The normalised Phong lobe k_s (n+2)/(2π) cos^n α, where α is the angle between ω_o and the mirror image of ω_i, and n the
// exponent.
#ifdef FEATURE_SPECULAR

// cos^n α, and 0 from 90 degrees on. 1 - cos α is half the squared difference of the two unit vectors, which stays accurate for
// small α. There pow() may lose all digits: Vulkan allows its logarithm an error of 2^-21, which n multiplies.
float get_lobe(ShadingData s, vec3 in_direction) {
    vec3 difference = reflect(-in_direction, s.normal) - s.out_direction;
    float one_minus_cos = 0.5 * dot(difference, difference);
    if (one_minus_cos >= 1.0) return 0.0;
    if (one_minus_cos > 0.125) return pow(1.0 - one_minus_cos, s.specular_exponent);
    // ln cos α = -2 artanh z with z = (1 - cos α) / (1 + cos α), by its series.
    float z = one_minus_cos / (2.0 - one_minus_cos);
    return exp(-2.0 * s.specular_exponent * z * (1.0 + z * z * (1.0 / 3.0 + z * z / 5.0)));
}

// The lobe's part of the BRDF, per steradian and colour channel.
vec3 get_phong_brdf(ShadingData s, vec3 in_direction) {
    return s.specular_albedo * ((s.specular_exponent + 2.0) / (2.0 * PI) * get_lobe(s, in_direction));
}

// The probability with which sampling chooses the lobe: its share of the albedo, in [0,1].
float get_phong_probability(ShadingData s) {
    float specular = max_component(s.specular_albedo);
    return specular > 0.0 ? specular / (max_component(s.diffuse_albedo) + specular) : 0.0;
}

// 1 - e^x for x <= 0, without cancellation where x is close to 0.
float get_one_minus_exp(float x) {
    if (x < -0.125) return 1.0 - exp(x);
    return -x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0 * (1.0 + x / 5.0))));
}

// Samples a unit direction of the lobe with get_phong_density(), for u uniform in [0,1)². It may point below the surface, where it carries no light.
vec3 sample_phong(ShadingData s, vec2 u) {
    // 1 - u_x = cos^(n+1) α. 1 - cos α is exact even where α is small.
    float one_minus_cos = get_one_minus_exp(log(1.0 - u.x) / (s.specular_exponent + 1.0));
    float sin_alpha = sqrt(one_minus_cos * (2.0 - one_minus_cos));
    float phi = 2.0 * PI * u.y;
    return get_shading_space(reflect(-s.out_direction, s.normal)) *
           vec3(cos(phi) * sin_alpha, sin(phi) * sin_alpha, 1.0 - one_minus_cos);
}

// The density (n+1) / (2π) cos^n α with respect to solid angle.
float get_phong_density(ShadingData s, vec3 in_direction) {
    return (s.specular_exponent + 1.0) / (2.0 * PI) * get_lobe(s, in_direction);
}
#endif
