// Textures as estimators see them.
#pragma once
#include <vector>

#include "support/render.h"

namespace lab {

// The albedo at texture coordinates, rendered from a row of quads with constant coordinates.
std::vector<vec3> albedo_at(Backend backend, const Texture& texture, const std::vector<vec2>& coordinates,
                            const vec3& factor = vec3(1));

// The same, but quads use the textures in turn.
std::vector<vec3> albedo_at(Backend backend, const std::vector<Texture>& textures, const std::vector<vec2>& coordinates,
                            const vec3& factor = vec3(1));

// Linear value of an sRGB-encoded byte (IEC 61966-2-1), in double, and linear colour of a texel.
double decode_srgb(uint8_t value);
glm::dvec3 texel(const Texture& texture, uint32_t column, uint32_t row);

}  // namespace lab
