// Facets have another probability, by the average of the channels; the coin comes after the point; GLSL reflects and refracts.
#include "07_multiple_importance_sampling/sample_lobes.glsl"
#include "sample_normal.glsl"
#ifdef FEATURE_MICROFACETS

float get_share_of_facets(ShadingData s) {
    if (s.is_rough_dielectric) return 1.0;
    float reflected = get_facet_albedo(s, dot(s.normal, s.out_direction)).x;
    float diffuse = (1.0 - reflected) * dot(s.diffuse_albedo, vec3(1.0 / 3.0));
    return mix(reflected / max(reflected + diffuse, 1e-6), 1.0, s.metalness);
}

float get_density_of_glass(ShadingData s, Facet facet, float cos_k) {
    if (!is_facet_seen(facet, cos_k)) return 0.0;
    float of_normal = get_normal_density(s, facet), reflected = get_glass_fresnel(s, facet.cos_o), eta = s.relative_index;
    if (cos_k > 0.0) return reflected * (of_normal / (4.0 * facet.cos_o));
    float along = facet.cos_o + eta * facet.cos_i;
    return (1.0 - reflected) * of_normal * (eta * eta * abs(facet.cos_i) / (along * along));
}

float get_density_with_facets(ShadingData s, vec3 toward) {
    float cos_k = dot(s.normal, toward), share = get_share_of_facets(s);
    Facet facet = get_facet(s, toward);
    if (s.is_rough_dielectric) return get_density_of_glass(s, facet, cos_k);
    float of_facets = get_normal_density(s, facet) / (4.0 * facet.cos_o);
    return share * of_facets + (1.0 - share) * (cos_k / PI);
}

BsdfSample sample_with_facets(ShadingData s, inout uvec2 seed) {
    vec2 u = get_random_numbers(seed);
    mat3 space = get_shading_space(s.normal);
    vec3 toward = space * sample_hemisphere(u);
    bool goes_through = false;
    if (happens(get_share_of_facets(s), seed)) {
        vec3 m = space * sample_normal(transpose(space) * s.out_direction, s.roughness, u);
        goes_through = s.is_rough_dielectric && happens(1.0 - get_glass_fresnel(s, dot(m, s.out_direction)), seed);
        toward = normalize(goes_through ? refract(-s.out_direction, m, 1.0 / s.relative_index) : reflect(-s.out_direction, m));
    }
    float cos_k = dot(s.normal, toward), density = get_density_with_facets(s, toward);
    bool is_lost = goes_through != (cos_k < 0.0) || !is_above_surface(s, toward);
    if (is_lost || !(density > 0.0)) return BsdfSample(s.normal, vec3(0.0), 0.0, 1.0);
    float scale = goes_through ? 1.0 / (s.relative_index * s.relative_index) : 1.0;
    return BsdfSample(toward, cos_k / scale * get_brdf(s, toward) / density, density, scale);
}
#endif

float get_bsdf_density(ShadingData s, vec3 in_direction) {
#ifdef FEATURE_MICROFACETS
    if (s.roughness > 0.0) return get_density_with_facets(s, in_direction);
#endif
    return get_lobes_density(s, in_direction);
}

BsdfSample sample_bsdf(ShadingData s, inout uvec2 seed) {
#ifdef FEATURE_MICROFACETS
    if (s.roughness > 0.0) return sample_with_facets(s, seed);
#endif
    if (s.is_dielectric) return sample_dielectric(s, seed);
    return sample_lobes(s, seed);
}
