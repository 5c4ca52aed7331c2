// Bounces that follow microfacets: sample the normal of a facet, then reflect or refract at it. Elsewhere they are those of
// chapter 7.
#include "07_multiple_importance_sampling/sample_lobes.glsl"
#include "sample_normal.glsl"
#ifdef FEATURE_MICROFACETS

// The probability with which a bounce follows the facets, and not the cosine: for an opaque surface, the facets' share
// of the reflected light, taking its brightest channel as its colour.
float get_facet_probability(ShadingData s) {
    if (s.is_rough_dielectric) return 1.0;
    if (FACET_SAMPLING == SAMPLES_COSINES) return 0.0;
    vec2 albedo = get_facet_albedo(s, dot(s.normal, s.out_direction));
    vec2 rest = 1.0 - albedo;
#ifndef FEATURE_MULTIPLE_SCATTERING
    rest.y = 0.0;
#endif
    rest *= max_component(s.diffuse_albedo);
    float facets = mix(albedo.x, albedo.y, s.metalness);
    return facets / max(facets + mix(rest.x, rest.y, s.metalness), 1e-6);
}

// The density of ω_k with respect to solid angle, of both ways together. A facet sends light from ω_o into one direction:
// around it, solid angles are those around m times 4 ω_o·m where it reflects, and (ω_o·m + η ω_k·m)² / (η² |ω_k·m|) where it
// refracts.
float get_microfacet_density(ShadingData s, vec3 in_direction) {
    float cos_i = dot(s.normal, in_direction);
    Facet facet = get_facet(s, in_direction);
    float density = get_normal_density(s, facet);
    if (!s.is_rough_dielectric) return mix(cos_i / PI, density / (4.0 * cos_i), get_facet_probability(s));
    if (!is_facet_seen(facet, cos_i)) return 0.0;
    float fresnel = get_glass_fresnel(s, facet.cos_o);
    if (cos_i > 0.0) return fresnel * density / (4.0 * facet.cos_o);
    float root = (facet.cos_o + s.relative_index * facet.cos_i) / s.relative_index;
    return (1.0 - fresnel) * density * -facet.cos_i / (root * root);
}

// The direction into which a facet of glass with the normal m refracts, as in chapter 6.
vec3 refract_at_facet(ShadingData s, vec3 m) {
    float cos_m = dot(m, s.out_direction);
    float contrast = (s.relative_index - 1.0) * (s.relative_index + 1.0);
    float eta_cos_m_t = sqrt(max(contrast + cos_m * cos_m, 0.0));
    return normalize(-contrast / (cos_m + eta_cos_m_t) * m - s.out_direction);
}

// Samples ω_i by a normal of the facets, or by the light below the coat.
BsdfSample sample_microfacets(ShadingData s, inout uvec2 seed) {
    mat3 space = get_shading_space(s.normal);
    bool is_refracted = false;
    vec3 omega;
    if (happens(get_facet_probability(s), seed)) {
        vec3 m = space * sample_normal(s.out_direction * space, s.roughness, get_random_numbers(seed));
        float cos_m = dot(m, s.out_direction);
        is_refracted = s.is_rough_dielectric && !happens(get_glass_fresnel(s, cos_m), seed);
        omega = is_refracted ? refract_at_facet(s, m) : 2.0 * cos_m * m - s.out_direction;
    } else {
        omega = space * sample_hemisphere(get_random_numbers(seed));
    }
    // Some facets send light to the wrong side of the surface, where it meets others. The model leaves it out.
    float cos_i = dot(s.normal, omega), density = get_microfacet_density(s, omega);
    if (!is_above_surface(s, omega) || (cos_i < 0.0) != is_refracted || !(density > 0.0))
        return BsdfSample(omega, vec3(0.0), 0.0, 1.0);
    float radiance_scale = is_refracted ? 1.0 / (s.relative_index * s.relative_index) : 1.0;
    return BsdfSample(omega, get_brdf(s, omega) * (cos_i / (density * radiance_scale)), density, radiance_scale);
}
#endif

// The density of sample_bsdf() with respect to solid angle.
float get_bsdf_density(ShadingData s, vec3 in_direction) {
#ifdef FEATURE_MICROFACETS
    if (s.roughness > 0.0) return get_microfacet_density(s, in_direction);
#endif
    return get_lobes_density(s, in_direction);
}

// Samples ω_k as the material scatters light, whatever it is.
BsdfSample sample_bsdf(ShadingData s, inout uvec2 seed) {
#ifdef FEATURE_MICROFACETS
    if (s.roughness > 0.0) return sample_microfacets(s, seed);
#endif
    if (s.is_dielectric) return sample_dielectric(s, seed);
    return sample_lobes(s, seed);
}
