// The bounding volume hierarchy of the `compute` backend, built on the CPU.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace lab {

// Four children in 128 bytes = 8 texels: bounds as low/high rows of x, y and z, then references. A reference is the index of an
// inner node, (triangle count << 28) | first triangle for a leaf, or 0 for no child.
struct BvhNode {
    // [axis][low, high][child], padded by bvh_padding times the child's largest coordinate; no child: low > high
    std::array<std::array<std::array<float, 4>, 2>, 3> bounds;
    std::array<uint32_t, 4> children;
    std::array<uint32_t, 4> padding;
};
static_assert(sizeof(BvhNode) == 128);

// Covers the rounding errors of box and triangle tests, a few times 2^-24 of the coordinates. The traversal pads as much for the
// ray's origin.
inline constexpr float bvh_padding = 0x1p-20f;

inline constexpr uint32_t bvh_leaf_shift = 28;
static_assert(max_triangle_count < size_t{1} << bvh_leaf_shift);
inline bool is_bvh_leaf(uint32_t reference) { return reference >> bvh_leaf_shift != 0; }

// A triangle's world-space vertices axis by axis, with ids in the fourth components: 48 bytes = 3 texels. The traversal permutes
// the axes by reading them in a different order.
struct BvhTriangle {
    vec3 x;
    uint32_t instance;
    vec3 y;
    uint32_t triangle;  // in Scene::triangles
    vec3 z;
    uint32_t padding;
};
static_assert(sizeof(BvhTriangle) == 48);

// A vector whose resize() leaves elements uninitialised, so that all threads can fill it.
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
    LargeArray<BvhTriangle> triangles;  // in leaf order
    uint32_t max_stack_entries = 1;     // of a traversal that pushes all but the nearest child, including a sentinel
    double build_seconds = 0;

    // The size that shaders are compiled with: a multiple of 16, so that most scenes share them.
    uint32_t stack_size() const { return (max_stack_entries + 15) / 16 * 16; }
};

// Number of triangles in all instances. Throws UserError for more than leaf references can address: 2^28 - 1.
uint64_t countable_triangles(const Scene& scene);

// World-space triangles of all instances; positions are transformed in double. Throws UserError for too many triangles, and for
// coordinates beyond 1e18, whose products would overflow in the triangle test.
LargeArray<BvhTriangle> world_triangles(const Scene& scene);

// Builds the tree of 0 to 2^28 - 1 triangles by the binned surface area heuristic (Wald, "On fast construction of SAH-based
// bounding volume hierarchies", 2007): up to 32 bins on 3 axes, all partitions of up to 4 triangles, binary splits collapsed to
// four children. The result does not depend on the number of threads.
Bvh build_bvh(std::span<const BvhTriangle> triangles);

}  // namespace lab
