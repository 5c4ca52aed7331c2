// Chapter 13, media: in fog, milk and smoke light scatters between the surfaces, too.
//
// A ray through a medium ends by chance: after a free flight, whose density σ_t exp(-σ_t t) is proportional to the transmittance,
// so that it cancels. What a flight does not reach it does not see. A collision scatters like a surface, but by a phase function,
// which has no normal and no cosine; its weight is the albedo. Light samples work there as in chapter 7, dimmed by Beer's law.
// A bounce in a medium counts like one at a surface.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "06_dielectrics/dielectric.glsl"
#include "11_microfacets/sample_bsdf.glsl"
#include "07_multiple_importance_sampling/weights.glsl"
#include "08_light_probes/light_probe_sampling.glsl"
#ifndef FEATURE_MEDIA
#include "07_multiple_importance_sampling/extend_path.glsl"
#else
#include "flights.glsl"
#include "medium.glsl"
#include "equiangular.glsl"
#include "scatter.glsl"
#include "extend_path.glsl"
#endif
