// Chapter 7, multiple importance sampling: both light samples and bounces look for light, and weights combine what they
// find.
//
// A light sample finds a direction with density p_l, a bounce with density p_b, both with respect to solid angle. With the
// balance heuristic the first has weight p_l / (p_l + p_b) and the second p_b / (p_l + p_b). The weights add up to one, so no
// light counts twice, and the strategy that suits a place better contributes most of it.
//
// Bounces now sample the whole BRDF: a glossy surface reflects most light into few directions. Splitting is gone, since it hardly
// pays, and so a single loop that traces in a single place is enough again.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "06_dielectrics/dielectric.glsl"
#include "sample_bsdf.glsl"
#include "choose_light.glsl"
#include "partition.glsl"
#include "count_scattering.glsl"
#include "weights.glsl"

// Light samples go to the light triangles. The background is left to bounces.
vec3 sample_direct_light(ShadingData s, inout uvec2 seed) { return sample_light_triangle(s, seed); }
float get_background_density(vec3 direction) { return 0.0; }

#include "extend_path.glsl"
