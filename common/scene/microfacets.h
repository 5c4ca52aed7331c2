// The microfacets of rough metal, plastic and glass.
#pragma once
#include "shaders/interface.h"

namespace lab {

// Below this Pr, 32 bits are too few for the directions of the lobe: it is a mirror's.
inline constexpr float smallest_roughness = 0.01f;

// Fills in what the microfacets of an opaque material reflect: integrals over the visible normals.
void integrate_albedo(Microfacets& microfacets);

}  // namespace lab
