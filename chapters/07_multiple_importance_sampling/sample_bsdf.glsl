// Bounces follow the whole BSDF: a dielectric's two directions, or the lobes of an opaque surface.
#include "07_multiple_importance_sampling/sample_lobes.glsl"

// The density of sample_bsdf() with respect to solid angle, for a direction above an opaque surface.
float get_bsdf_density(ShadingData s, vec3 in_direction) { return get_lobes_density(s, in_direction); }

// Samples ω_k: at a dielectric one of two directions, elsewhere with the density get_bsdf_density().
BsdfSample sample_bsdf(ShadingData s, inout uvec2 seed) {
    if (s.is_dielectric) return sample_dielectric(s, seed);
    return sample_lobes(s, seed);
}
