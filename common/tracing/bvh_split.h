// How the builder of the tree splits the triangles of a node.
#pragma once
#include <bit>
#include <memory>
#include <optional>
#include <span>

#include "scene/scene.h"

namespace lab::bvh {

// Four numbers in a register. The fourth is of no meaning unless stated.
using Float4 [[gnu::vector_size(16)]] = float;

struct Box {
    Float4 low, high;

    void add(const Box& box) {
        low = box.low < low ? box.low : low;
        high = box.high > high ? box.high : high;
    }
    Bounds bounds() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }
};

// What the build moves around: the bounds of a triangle and where to find it.
class Primitive {
  public:
    Primitive() = default;
    Primitive(const Bounds& bounds, uint32_t triangle)
        : low_{bounds.low.x, bounds.low.y, bounds.low.z, 0},
          high_{bounds.high.x, bounds.high.y, bounds.high.z, std::bit_cast<float>(triangle | id_bits)} {}

    Box box() const { return {low_, high_}; }
    Float4 centroid() const { return 0.5f * low_ + 0.5f * high_; }
    uint32_t triangle() const { return std::bit_cast<uint32_t>(float{high_[3]}) & ~id_bits; }

  private:
    static constexpr uint32_t id_bits = 1u << 30;  // make an id an ordinary number, quick to compute with
    static_assert(max_triangle_count < id_bits);
    Float4 low_, high_;
};

// Primitives side by side that become one subtree.
struct Range {
    std::span<Primitive> primitives;
    Bounds bounds;
    size_t depth = 0;
    bool is_leaf = false;
};

// Half the surface area, in double because the square of a large coordinate overflows a float.
inline double half_area(Float4 size) {
    const double x = size[0], y = size[1], z = size[2];
    return x * y + y * z + z * x;
}

inline double half_area(const Bounds& bounds) {
    const vec3 size = bounds.high - bounds.low;
    return half_area(Float4{size.x, size.y, size.z, 0});
}

Bounds bounds_of(std::span<const Primitive> primitives);

// Splits ranges of at least two primitives. All threads share the work on those that are larger than a task.
class Splitter {
  public:
    explicit Splitter(std::span<const Primitive> primitives);

    size_t task_size() const { return task_size_; }

    // The two halves of a range, or nothing where a leaf is cheaper. A node costs as much as a triangle.
    std::optional<std::array<Range, 2>> split(const Range& range) const;

  private:
    template <typename Sum, typename Add>
    void gather(std::span<const Primitive> primitives, Sum& sum, const Add& add) const;
    template <typename IsLeft>
    void partition(std::span<Primitive> primitives, const IsLeft& is_left) const;

    std::span<const Primitive> primitives_;
    std::unique_ptr<Primitive[]> scratch_;  // room for as many
    size_t task_size_;
};

}  // namespace lab::bvh
