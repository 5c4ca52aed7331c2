// Chapter 14, many lights: light samples go to the lights that matter at x_k.
//
// Until now a light sample chose a triangle by its power alone, wherever x_k is. With thousands of lamps most of these are far
// away or turned away. Here the triangles are the leaves of a tree. Each node knows a sphere around its triangles, the mean of
// their normals and how far these differ from it, and their power. From these and x_k follows its importance, an estimate of
// power · cos θ' · cos θ / r². A light sample descends from the root, and each time chooses one of four children with
// probabilities proportional to their importance.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "06_dielectrics/dielectric.glsl"
#include "11_microfacets/sample_bsdf.glsl"
#include "light_tree.glsl"

// Light samples of earlier chapters, which now choose by the tree.
#define choose_light_triangle choose_light
#include "07_multiple_importance_sampling/weights.glsl"
#undef choose_light_triangle
#define sample_direct_light sample_light
#include "08_light_probes/light_probe_sampling.glsl"
#undef sample_direct_light

// Estimates the direct light at x_k, and remembers x_k for the weight of the bounce that follows.
vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    set_receiver(s);
    return sample_light(s, seed);
}

#ifdef FEATURE_MEDIA
#include "13_media/flights.glsl"
#include "13_media/medium.glsl"
#include "13_media/equiangular.glsl"
#define choose_light_triangle choose_light
#define sample_scattered_light sample_light_in_media
#include "13_media/scatter.glsl"
#undef sample_scattered_light
#undef choose_light_triangle

// The same in a medium, where x_k has no normal.
vec3 sample_scattered_light(ShadingData s, Sides sides, inout uvec2 seed) {
    set_receiver(s);
    return sample_light_in_media(s, sides, seed);
}
#endif

#define get_shading_data get_weighed_shading_data
#ifdef FEATURE_MEDIA
#include "13_media/extend_path.glsl"
#else
#include "07_multiple_importance_sampling/extend_path.glsl"
#endif
#undef get_shading_data
