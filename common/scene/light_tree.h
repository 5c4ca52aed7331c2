// A tree over the emissive triangles of a scene, by which light samples find those that matter at a point.
#pragma once
#include <cstdint>
#include <vector>

#include "scene/light_table.h"

namespace lab {

struct LightTree {
    // The root comes first; each leaf is one triangle of the table. A node has four children, two levels of a binary tree. Bounds
    // are a little larger than necessary, so that the rounding errors of shaders cannot hide a light.
    std::vector<LightNode> nodes;
    // One for each emissive triangle of each instance, also of those that the table leaves out since others are in their place.
    std::vector<LightLeaf> leaves;
    // Where to find them, for shaders/world/scene.glsl: per triangle, then per instance.
    std::vector<uint32_t> places;
};

// Deepest leaf of the binary tree, so that 32 bits hold the way from the root. Trees of up to 2^24 triangles are balanced where
// they would exceed it.
inline constexpr uint32_t max_light_tree_depth = 32;

// Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018, without the splitting.
// Triangles that emit nothing have no power. Empty if the table is.
LightTree build_light_tree(const Scene& scene, const LightTable& table);

}  // namespace lab
