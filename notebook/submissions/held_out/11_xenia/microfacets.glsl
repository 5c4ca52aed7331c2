// Microfacets: rough surfaces consist of tiny facets, each one a smooth mirror or dielectric.
#include "06_dielectrics/dielectric.glsl"
#ifdef FEATURE_MICROFACETS

// The GGX distribution (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007): the area D(m)
// of facets with the normal m, for each solid angle and each area of the surface, so that ∫ D(m) n·m dm = 1.
// The part of m along the surface gives sin² θ_m, and keeps its digits where α is small.
float get_facet_distribution(ShadingData s, vec3 m) {
    float cos_m = dot(s.normal, m);
    vec3 along = cross(s.normal, m);
    float quotient = s.roughness / (s.roughness * s.roughness * cos_m * cos_m + dot(along, along));
    return quotient * quotient / PI;
}

// cos θ (1 + 2 Λ) = √(cos² θ + α² sin² θ). Smith's Λ says how many facets hide others: of those that face the direction
// 1 / (1 + Λ) are visible.
float get_smith_term(ShadingData s, float cos_theta) {
    return sqrt(mix(s.roughness * s.roughness, 1.0, cos_theta * cos_theta));
}

// G / (4 cos θ_i cos θ_o) of facets that are visible from both sides: G = 1 / (1 + Λ_i + Λ_o) takes into account that the
// high ones are more often seen from either (Heitz, "Understanding the Masking-Shadowing Function", JCGT 3(2) 2014).
float get_visibility(ShadingData s, float cos_i, float cos_o) {
    // G = G_1(i) G_1(o) with G_1 = 2 cos / (cos + term)
    float masking = 1.0 / (cos_o + get_smith_term(s, cos_o));
    float shadowing = 1.0 / (cos_i + get_smith_term(s, cos_i));
    return masking * shadowing;
}

// Fresnel's reflectance of a facet of glass, or of the coat on an opaque surface.
float get_glass_fresnel(ShadingData s, float cos_m) {
    float square = (s.relative_index - 1.0) * (s.relative_index + 1.0) + cos_m * cos_m;
    return square > 0.0 ? get_fresnel_reflectance(cos_m, s.relative_index, sqrt(square)) : 1.0;
}

// Fresnel's reflectance of an opaque surface's facet, by Schlick's approximation where it is metal: Kd at normal incidence.
vec3 get_fresnel(ShadingData s, float cos_m) {
    float root = max(1.0 - cos_m, 0.0);
    vec3 metal = s.diffuse_albedo + (1.0 - s.diffuse_albedo) * (root * root * root * root * root);
    return mix(vec3(get_glass_fresnel(s, cos_m)), metal, s.metalness);
}

// E(ω): the fraction of light from this direction that facets reflect: x for the coat, y for a surface with F = 1.
vec2 get_facet_albedo(ShadingData s, float cos_theta) {
    float position = sqrt(clamp(cos_theta, 0.0, 1.0)) * float(MICROFACET_ALBEDO_COUNT - 1u);
    uint i = min(uint(position), MICROFACET_ALBEDO_COUNT - 2u);
    return mix(microfacets[s.material].albedo[i], microfacets[s.material].albedo[i + 1u], position - float(i));
}

// The diffuse light from below the coat, where light that the facets did not reflect is scattered evenly (Kelemen and
// Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model", Eurographics 2001). Of white light from ω_i it
// takes the fraction 1 - E(ω_i) that the coat lets through. With the same factor on the way out nothing is lost, and the BRDF
// is reciprocal.
vec3 get_diffuse_brdf(ShadingData s, float cos_i, float cos_o) {
    vec2 rest = (1.0 - get_facet_albedo(s, cos_i)) * (1.0 - get_facet_albedo(s, cos_o)) /
                (PI * max(1.0 - microfacets[s.material].mean_albedo, 1e-6));
    vec3 brdf = (1.0 - s.metalness) * s.diffuse_albedo * rest.x;
#ifdef FEATURE_MULTIPLE_SCATTERING
    // Light that facets of metal reflect several times (Kulla and Conty, "Revisiting Physically Based Shading at Imageworks",
    // SIGGRAPH 2017 courses): each time the mean of F remains, and the fraction Ē of that escapes.
    vec3 mean_fresnel = s.diffuse_albedo + (1.0 - s.diffuse_albedo) / 21.0;
    float mean_albedo = microfacets[s.material].mean_albedo.y;
    brdf += s.metalness * mean_fresnel * mean_fresnel * mean_albedo / (1.0 - mean_fresnel * (1.0 - mean_albedo)) * rest.y;
#endif
    return brdf;
}

// The facets that send light from ω_i to ω_o.
struct Facet {
    vec3 normal;  // m, unit length, on the side of n
    float cos_i;  // m·ω_i
    float cos_o;  // m·ω_o
};

// The facets between ω_i and ω_o. They reflect if ω_i is above the surface: m lies along ω_o + ω_i, at the same angle to both.
// Else they refract: along ω_o + η ω_i.
Facet get_facet(ShadingData s, vec3 in_direction) {
    bool is_reflected = dot(s.normal, in_direction) > 0.0;
    vec3 sum = s.out_direction + (is_reflected ? 1.0 : s.relative_index) * in_direction;
    vec3 m = normalize(sum);
    if (dot(s.normal, m) < 0.0) m = -m;
    // Half the length of the sum is this cosine, and exact also where it is small.
    if (is_reflected) return Facet(m, 0.5 * length(sum), 0.5 * length(sum));
    return Facet(m, dot(m, in_direction), dot(m, s.out_direction));
}

// Whether ω_o and ω_i are each on the same side of the facet as of the surface.
bool is_facet_seen(Facet facet, float cos_i) { return facet.cos_o > 0.0 && facet.cos_i * cos_i > 0.0; }

// The BRDF of rough metal and plastic.
vec3 get_opaque_brdf(ShadingData s, vec3 in_direction) {
    float cos_i = dot(s.normal, in_direction), cos_o = dot(s.normal, s.out_direction);
    Facet facet = get_facet(s, in_direction);
    return get_fresnel(s, facet.cos_o) * (get_facet_distribution(s, facet.normal) * get_visibility(s, cos_i, cos_o)) +
           get_diffuse_brdf(s, cos_i, cos_o);
}

// The BSDF of rough glass for radiance. Where light goes through it has the sign of n·ω_i, so that their product is positive.
float get_rough_dielectric_bsdf(ShadingData s, vec3 in_direction) {
    float cos_i = dot(s.normal, in_direction), cos_o = dot(s.normal, s.out_direction);
    Facet facet = get_facet(s, in_direction);
    if (!is_facet_seen(facet, cos_i)) return 0.0;
    float fresnel = get_glass_fresnel(s, facet.cos_o), distribution = get_facet_distribution(s, facet.normal);
    if (cos_i > 0.0) return fresnel * distribution * get_visibility(s, cos_i, cos_o);
    // Light that goes through meets facets from their two sides: G = 1 / ((1 + Λ_i) (1 + Λ_o)).
    float root = facet.cos_o + s.relative_index * facet.cos_i;
    float masked_cosines = (get_smith_term(s, cos_i) - cos_i) * (get_smith_term(s, cos_o) + cos_o);
    return 4.0 * facet.cos_i * facet.cos_o * (1.0 - fresnel) * distribution / (masked_cosines * root * root);
}
#endif
