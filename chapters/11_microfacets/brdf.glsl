// How surfaces scatter light: by microfacets if the material has them, else as in earlier chapters.
#include "microfacets.glsl"

// ρ(x, ω_i, ω_o). Only rough glass has light from below the surface.
vec3 get_brdf(ShadingData s, vec3 in_direction) {
#ifdef FEATURE_MICROFACETS
    if (s.is_rough_dielectric) return vec3(get_rough_dielectric_bsdf(s, in_direction));
    if (s.roughness > 0.0) return get_opaque_brdf(s, in_direction);
#endif
    return get_lobes_brdf(s, in_direction);
}
