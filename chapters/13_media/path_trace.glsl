// Chapter 13, media: in fog, milk and smoke light scatters between the surfaces, too.
//
// A ray through a medium ends by chance: after a free flight, whose density σ_t exp(-σ_t t) is proportional to the transmittance,
// so that it cancels. What a flight does not reach it does not see. A collision scatters like a surface, but by a phase function,
// which has no normal and no cosine; its weight is the albedo. Light samples work there as in chapter 7, dimmed by Beer's law.
// A bounce in a medium counts like one at a surface.
//
// The loop is the one in extend_path.glsl of this folder. Where a scene has no media, it is still that of chapter 7.
#include "08_light_probes/path_trace.glsl"
