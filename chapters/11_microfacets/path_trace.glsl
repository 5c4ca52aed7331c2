// Chapter 11, microfacets: rough metal, plastic and glass reflect light into a lobe whose shape follows from the normals of
// tiny facets.
//
// Each facet is a smooth mirror or piece of glass, as in chapter 6. The GGX distribution D says how many facets have which
// normal, and Smith's G how many of those light reaches from both sides. A bounce samples a normal m and goes where a
// smooth facet with this normal would send it. Best are the normals that are visible from ω_o: then all that is left for
// the weight is Fresnel's F and the share of facets in shadow.
//
// How much light a rough surface scatters is in brdf.glsl in this folder, how a bounce leaves it in sample_bsdf.glsl. The rest of
// the path is that of chapter 10.
#include "08_light_probes/path_trace.glsl"
