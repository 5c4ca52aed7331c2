// Microfacets of rough metal, plastic and glass.
#pragma once
#include "shaders/interface.h"

namespace lab {

// Below this Pr, 32 bits cannot resolve the directions of the lobe: it acts as a mirror.
inline constexpr float smallest_roughness = 0.01f;

// Fills in the reflectances of an opaque material's microfacets: integrals over the visible normals.
void integrate_albedo(Microfacets& microfacets);

}  // namespace lab
