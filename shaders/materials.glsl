// Bidirectional reflectance distribution function (BRDF) ρ of the opaque materials.

#ifdef FEATURE_SPECULAR
// cos^n α, where α is the angle between ω_o and the mirror image of ω_i and n the exponent; 0 from 90 degrees on.
// 1 - cos α is half the square of the difference between the two unit vectors: it keeps its digits where α is small.
// There a device's pow() may have lost all of them: Vulkan allows its logarithm an error of 2^-21, times n.
float get_lobe(ShadingData s, vec3 in_direction, vec3 out_direction) {
    vec3 difference = reflect(-in_direction, s.normal) - out_direction;
    float one_minus_cos = 0.5 * dot(difference, difference);
    if (one_minus_cos >= 1.0) return 0.0;
    if (one_minus_cos > 0.125) return pow(1.0 - one_minus_cos, s.specular_exponent);
    // ln cos α = -2 artanh z with z = (1 - cos α) / (1 + cos α), by its series.
    float z = one_minus_cos / (2.0 - one_minus_cos);
    return exp(-2.0 * s.specular_exponent * z * (1.0 + z * z * (1.0 / 3.0 + z * z / 5.0)));
}
#endif

// π ρ(x, ω_i, ω_o) for unit directions that point away from the surface. Times π, so that a Lambertian surface has
// exactly its albedo. The glossy part is the normalised Phong lobe k_s (n+2)/(2π) cos^n α of the blog's BRDF.
vec3 get_pi_brdf(ShadingData s, vec3 in_direction, vec3 out_direction) {
#ifdef FEATURE_SPECULAR
    float lobe = 0.5 * (s.specular_exponent + 2.0) * get_lobe(s, in_direction, out_direction);
    return s.diffuse_albedo + lobe * s.specular_albedo;
#else
    return s.diffuse_albedo;
#endif
}

// Whether light can leave x along the unit direction: above the horizon of the shading normal and of the triangle.
bool is_above_surface(ShadingData s, vec3 direction) {
    return dot(s.normal, direction) > 0.0 && dot(s.geometric_normal, direction) > 0.0;
}
