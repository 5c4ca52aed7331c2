// Textures as the estimators see them.
#pragma once
#include <vector>

#include "support/render.h"

namespace lab {

// The albedo at texture coordinates: that of quads in a row, each of which has the same coordinates
// everywhere.
std::vector<vec3> albedo_at(Backend backend, const Texture& texture, const std::vector<vec2>& coordinates,
                            const vec3& factor = vec3(1));

// The same where neighbours have different textures: these in turn.
std::vector<vec3> albedo_at(Backend backend, const std::vector<Texture>& textures,
                            const std::vector<vec2>& coordinates, const vec3& factor = vec3(1));

// Linear value of an encoded byte (IEC 61966-2-1), in double, and linear colour of a texel.
double decode_srgb(uint8_t value);
glm::dvec3 texel(const Texture& texture, uint32_t column, uint32_t row);

}  // namespace lab
