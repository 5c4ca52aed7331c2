// Chapter 16, denoising: less noise for a bias that can be seen.
//
// The paths are those of chapter 15. What is new begins when they have ended: filter.glsl in this folder replaces each pixel by a
// weighted mean of those around it, if --filter asks for it.
#include "08_light_probes/path_trace.glsl"
