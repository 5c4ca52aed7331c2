// Chapter 17, derivatives: how does the picture change with the albedo of a material?
//
// The light of a path is a product of albedos, the cosines and densities of its directions, and the emission at its end. One albedo
// is a factor of it as often as the material scatters: count_scattering.glsl in this folder counts that, and sample_loop.glsl adds
// the derivative to the pixel instead of the light. The paths are those of chapter 14.
#include "08_light_probes/path_trace.glsl"
