// The bounding volume hierarchy of the `compute` backend, built on the CPU.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace lab {

// Four children side by side, 128 bytes = 8 texels: bounds as low/high rows of x, y and z, then references.
// A reference is the index of an inner node, or (number of triangles << 28) | first triangle for a leaf, or 0
// where there is no child (no child is the root).
struct BvhNode {
    std::array<std::array<std::array<float, 4>, 2>, 3> bounds;  // [axis][low, high][child]; none: low > high
    std::array<uint32_t, 4> children;
    std::array<uint32_t, 4> padding;

    // The bounds of a child: those of its triangles, grown by bvh_padding times their largest coordinate.
    Bounds child_bounds(size_t child) const {
        const auto& [x, y, z] = bounds;
        return {{x[0][child], y[0][child], z[0][child]}, {x[1][child], y[1][child], z[1][child]}};
    }
};
static_assert(sizeof(BvhNode) == 128);

// Covers the rounding errors of boxes and triangles in the traversal, which adds as much for the ray's
// origin: these are a few times 2^-24 of the coordinates.
inline constexpr float bvh_padding = 0x1p-20f;

inline constexpr uint32_t bvh_leaf_shift = 28;
static_assert(max_triangle_count < size_t{1} << bvh_leaf_shift);
inline bool is_bvh_leaf(uint32_t reference) { return reference >> bvh_leaf_shift != 0; }

// World-space coordinates of a triangle's vertices, one axis after the other, with its ids in the fourth
// components: 48 bytes = 3 texels. So the traversal permutes the axes by the order in which it reads them.
struct BvhTriangle {
    vec3 x;
    uint32_t instance;
    vec3 y;
    uint32_t triangle;  // in Scene::triangles
    vec3 z;
    uint32_t padding;
};
static_assert(sizeof(BvhTriangle) == 48);

// An array that grows without being set to zero, so that all threads can fill it.
template <typename T>
struct Uninitialized : std::allocator<T> {
    template <typename U>
    struct rebind {
        using other = Uninitialized<U>;
    };
    void construct(T*) {}
    void construct(T* place, const T& value) { std::construct_at(place, value); }
};
template <typename T>
using LargeArray = std::vector<T, Uninitialized<T>>;

struct Bvh {
    LargeArray<BvhNode> nodes;          // node 0 is the root; children follow their parents
    LargeArray<BvhTriangle> triangles;  // in the order of the leaves
    uint32_t max_stack_entries = 1;  // for a traversal that pushes all but the nearest child, and a sentinel
    double build_seconds = 0;
};

// Triangles of all instances. Throws UserError for more than references to leaves can count: 2^28 - 1.
uint64_t countable_triangles(const Scene& scene);

// World-space triangles of all instances; positions are transformed in double. Throws UserError for too many,
// and for coordinates beyond 1e18, whose products would overflow in the triangle test.
LargeArray<BvhTriangle> world_triangles(const Scene& scene);

// Binned surface area heuristic (up to 32 bins, 3 axes; all ways to divide up to 4 triangles, which may be a
// leaf), collapsed to four children.
// Takes any number of triangles below 2^28, also none. Large inputs are built by several threads; the result
// does not depend on how many. Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007.
Bvh build_bvh(std::span<const BvhTriangle> triangles);

}  // namespace lab
