// Bidirectional reflectance distribution function (BRDF) ρ of the opaque materials.

// π ρ(x, ω_i, ω_o) for unit directions that point away from the surface. Times π, so that a Lambertian surface has
// exactly its albedo. The glossy part is the normalised Phong lobe k_s (n+2)/(2π) cos^n α of the blog's BRDF, where α
// is the angle between ω_o and the mirror image of ω_i.
vec3 get_pi_brdf(ShadingData s, vec3 in_direction, vec3 out_direction) {
#ifdef FEATURE_SPECULAR
    float cos_alpha = max(dot(reflect(-in_direction, s.normal), out_direction), 0.0);
    float lobe = cos_alpha > 0.0 ? pow(min(cos_alpha, 1.0), s.specular_exponent) : 0.0;
    return s.diffuse_albedo + s.specular_albedo * (0.5 * (s.specular_exponent + 2.0) * lobe);
#else
    return s.diffuse_albedo;
#endif
}

// Whether light can leave x along the unit direction: above the horizon of the shading normal and of the triangle.
bool is_above_surface(ShadingData s, vec3 direction) {
    return dot(s.normal, direction) > 0.0 && dot(s.geometric_normal, direction) > 0.0;
}
