#include "11_microfacets/brdf.glsl"
