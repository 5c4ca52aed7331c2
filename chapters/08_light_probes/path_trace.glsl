// Chapter 8, light probes: light comes from all around, and light samples go to the bright directions.
//
// The probe is an image of all directions. Each of its cells, one per texel, is chosen with a probability P proportional to its
// mean luminance times its solid angle Δω. Within a cell all directions are equally likely: density P/Δω with respect to solid
// angle. The weights of chapter 7 do the rest. Where there are light triangles, too, each light sample goes either to them or to
// the probe; the densities include the probability of that choice.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "06_dielectrics/dielectric.glsl"
#include "sample_bsdf.glsl"
#include "choose_light.glsl"
#include "partition.glsl"
#include "count_scattering.glsl"
#include "07_multiple_importance_sampling/weights.glsl"
#include "light_probe_sampling.glsl"
#include "extend_path.glsl"
