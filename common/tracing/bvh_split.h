// How the builder of the tree splits the triangles of a node.
#pragma once
#include <array>
#include <bit>
#include <deque>
#include <limits>
#include <optional>
#include <span>

#include "scene/scene.h"

namespace lab::bvh {

// Four numbers in a register. The fourth is of no meaning unless stated.
using Float4 [[gnu::vector_size(16)]] = float;

// Half the surface area of a box, in double because the square of a large coordinate overflows a float.
inline double half_area(double x, double y, double z) { return x * y + y * z + z * x; }

struct Box {
    Float4 low, high;

    void add(const Box& box) {
        low = box.low < low ? box.low : low;
        high = box.high > high ? box.high : high;
    }
    void add(Float4 point) { add(Box{point, point}); }
    Bounds bounds() const { return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}; }

    double half_area() const {
        const Float4 size = high - low;
        return bvh::half_area(size[0], size[1], size[2]);
    }
};

const Box empty_box{Float4{} + std::numeric_limits<float>::infinity(),
                    Float4{} - std::numeric_limits<float>::infinity()};

// What the build moves around: the bounds of a triangle and where to find it.
class Primitive {
  public:
    Primitive() = default;
    Primitive(const Bounds& bounds, uint32_t triangle)
        : low_{bounds.low.x, bounds.low.y, bounds.low.z, 0},
          high_{bounds.high.x, bounds.high.y, bounds.high.z, std::bit_cast<float>(triangle | id_bits)} {}

    Box box() const { return {low_, high_}; }
    uint32_t triangle() const { return std::bit_cast<uint32_t>(float{high_[3]}) & ~id_bits; }

    // Twice the centre of its bounds.
    Float4 place() const { return low_ + high_; }
    float place(int axis) const { return low_[axis] + high_[axis]; }

  private:
    static constexpr uint32_t id_bits = 1u << 30;  // make an id an ordinary number, quick to compute with
    static_assert(max_triangle_count < id_bits);
    Float4 low_, high_;
};

// The bounds of primitives and of their places.
struct Extent {
    Box box = empty_box, places = empty_box;

    void add(const Primitive& primitive) {
        box.add(primitive.box());
        places.add(primitive.place());
    }
    void add(const Extent& extent) {
        box.add(extent.box);
        places.add(extent.places);
    }
};

// Primitives side by side that become one subtree.
struct Range {
    std::span<Primitive> primitives;
    Primitive* room;  // for as many: its halves lie there, and theirs here again
    Box box, places;
    double area;         // half of that of the box
    uint32_t first = 0;  // in the order of the leaves
    uint32_t depth = 0;
    const std::array<Range, 2>* halves = nullptr;  // if they are known
};
using Halves = std::array<Range, 2>;

// The two halves of a range, or nothing where a leaf is cheaper. A node costs as much as a triangle.
std::optional<Halves> split(const Range& range);

// Splits a range and its halves, down to those of at most `size` primitives, with all threads: each takes as
// many at a time.
class LargeRanges {
  public:
    LargeRanges(Range& all, size_t size);

  private:
    std::deque<Halves> halves_;
};

}  // namespace lab::bvh
