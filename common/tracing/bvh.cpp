#include "tracing/bvh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "clock.h"
#include "error.h"
#include "parallel.h"

namespace lab {
namespace {

constexpr size_t max_bin_count = 32;
constexpr size_t max_leaf_triangles = 4;
// At this many splits above each other, ranges are halved instead, which bounds the stack of the traversal. Only triangles whose
// sizes shrink geometrically need so many.
constexpr size_t max_depth = 64;

// Four SIMD lanes; the fourth is meaningless unless stated.
using Float4 [[gnu::vector_size(16)]] = float;
using Int4 [[gnu::vector_size(16)]] = int;

struct Box {
    Float4 low = Float4{} + std::numeric_limits<float>::infinity();
    Float4 high = Float4{} - std::numeric_limits<float>::infinity();

    void add(const Box& box) {
        low = box.low < low ? box.low : low;
        high = box.high > high ? box.high : high;
    }
    // In double, because the square of a large coordinate overflows a float.
    double half_area() const {
        const Float4 size = high - low;
        const double x = size[0], y = size[1], z = size[2];
        return x * y + y * z + z * x;
    }
};

// The bounds of a triangle, with its index in the fourth lane of the upper corner.
struct Primitive {
    static constexpr uint32_t id_bits = 1u << 30;  // turns an index into a normal float, which is fast to compute with
    static_assert(max_triangle_count < id_bits);
    Float4 low, high;

    Box box() const { return {low, high}; }
    uint32_t triangle() const { return std::bit_cast<uint32_t>(float{high[3]}) & ~id_bits; }
    Float4 centre() const { return low + high; }  // twice the centre
};

// Adjacent primitives that become one subtree.
struct Range {
    std::span<Primitive> primitives;
    Primitive* room;  // scratch memory of the same size: the halves go there, and theirs back here
    Box box;
    uint32_t first;  // of its triangles, in leaf order
    uint32_t depth;  // number of splits above it
    double area = box.half_area();
};
using Halves = std::array<Range, 2>;

// The primitives on one side of a plane.
struct Side {
    Box box;
    uint32_t count = 0;

    void add(const Side& side) {
        box.add(side.box);
        count += side.count;
    }
    double cost() const { return box.half_area() * count; }  // NaN for an empty side
};

// A split plane between two bins.
struct Plane {
    double cost = std::numeric_limits<double>::infinity();  // surface area heuristic, both sides together
    int axis = 0;
    int bin = 0;  // the first one on the right
};

// The primitives of a range, counted by centre in bins of equal width along each axis.
class Bins {
  public:
    explicit Bins(const Range& range) : count_(static_cast<int>(std::min(max_bin_count, 4 + range.primitives.size() / 2))) {
        Box centres;
        for (const Primitive& primitive : range.primitives) centres.add({primitive.centre(), primitive.centre()});
        low_ = centres.low;
        last_ = Float4{} + (static_cast<float>(count_) - 0.5f);
        // Along an axis where the bins have almost no width, all primitives go to bin 0.
        const Float4 scale = static_cast<float>(count_) / (centres.high - low_);
        bins_per_length_ = scale <= std::numeric_limits<float>::max() ? scale : Float4{};
        // Neighbours often share a bin and would have to wait for each other's sum: so alternate between the two halves.
        const auto primitives = range.primitives;
        const size_t middle = primitives.size() / 2;
        for (size_t i = 0; i < middle; ++i) {
            add(primitives[i]);
            add(primitives[middle + i]);
        }
        if (primitives.size() % 2 != 0) add(primitives.back());
    }

    bool is_left(const Primitive& primitive, const Plane& plane) const {
        const float bin = (primitive.centre()[plane.axis] - low_[plane.axis]) * bins_per_length_[plane.axis];
        return bin < static_cast<float>(plane.bin);
    }
    Side left(const Plane& plane) const { return sum(plane.axis, 0, plane.bin); }
    Side right(const Plane& plane) const { return sum(plane.axis, plane.bin, count_); }

    // The plane of least cost; infinite if no plane has primitives on both sides.
    Plane cheapest_plane() const {
        Plane best;
        for (int axis = 0; axis < 3; ++axis) {
            std::array<double, max_bin_count> right_cost;  // of bins i, i + 1, ...
            Side side;
            for (int i = count_ - 1; i > 0; --i) {
                side.add(axes_[axis][i]);
                right_cost[i] = side.cost();
            }
            side = {};
            for (int i = 1; i < count_; ++i) {
                side.add(axes_[axis][i - 1]);
                const double cost = side.cost() + right_cost[i];
                if (cost < best.cost) best = {cost, axis, i};
            }
        }
        return best;
    }

  private:
    void add(const Primitive& primitive) {
        const Float4 place = (primitive.centre() - low_) * bins_per_length_;
        const Int4 bins = __builtin_convertvector(place < last_ ? place : last_, Int4);
        const Side one{primitive.box(), 1};
        // Unrolled, so that the compiler knows the lanes.
        axes_[0][static_cast<uint32_t>(bins[0])].add(one);
        axes_[1][static_cast<uint32_t>(bins[1])].add(one);
        axes_[2][static_cast<uint32_t>(bins[2])].add(one);
    }
    Side sum(int axis, int begin, int end) const {
        Side sum;
        for (int i = begin; i < end; ++i) sum.add(axes_[axis][i]);
        return sum;
    }

    int count_;
    Float4 low_, bins_per_length_;
    Float4 last_;  // the middle of the last bin, in bins
    std::array<std::array<Side, max_bin_count>, 3> axes_;
};

Halves halves_of(const Range& range, const Side& left, const Side& right) {
    const auto half = [&](size_t begin, const Side& side) {
        return Range{{range.room + begin, side.count},
                     range.primitives.data() + begin,
                     side.box,
                     static_cast<uint32_t>(range.first + begin),
                     range.depth + 1};
    };
    return {half(0, left), half(left.count, right)};
}

// Halves a range along its longest axis, for coincident centres and trees that are too deep.
Halves halve(const Range& range) {
    const Float4 size = range.box.high - range.box.low;
    const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
    const auto middle = range.primitives.begin() + range.primitives.size() / 2;
    std::ranges::nth_element(range.primitives, middle, {}, [&](const Primitive& p) { return p.centre()[axis]; });
    std::ranges::copy(range.primitives, range.room);
    std::array<Side, 2> sides;
    for (auto p = range.primitives.begin(); p != range.primitives.end(); ++p) sides[p >= middle].add({p->box(), 1});
    return halves_of(range, sides[0], sides[1]);
}

// The cheapest of all partitions of a few primitives, if any is cheaper than a leaf. The first one stays on the left.
std::optional<Halves> split_few(const Range& range) {
    const auto primitives = range.primitives;
    if (primitives.size() < 2) return {};
    double best_cost = range.area * static_cast<double>(primitives.size() - 1);  // of a leaf, minus that of a node
    uint32_t best = 0;  // one bit per primitive, set if it goes to the right
    std::array<Side, 2> best_sides;
    for (uint32_t right = 2; right < 1u << primitives.size(); right += 2) {
        std::array<Side, 2> sides;
        for (size_t i = 0; i < primitives.size(); ++i) sides[right >> i & 1].add({primitives[i].box(), 1});
        const double cost = sides[0].cost() + sides[1].cost();
        if (cost < best_cost) {
            best_cost = cost;
            best = right;
            best_sides = sides;
        }
    }
    if (best == 0) return {};
    std::array<size_t, 2> next{0, best_sides[0].count};
    for (size_t i = 0; i < primitives.size(); ++i) range.room[next[best >> i & 1]++] = primitives[i];
    return halves_of(range, best_sides[0], best_sides[1]);
}

// The two halves of a range, or nothing if a leaf is cheaper. A node costs as much as a triangle.
std::optional<Halves> split(const Range& range) {
    const size_t count = range.primitives.size();
    if (count <= max_leaf_triangles) return split_few(range);
    if (range.depth + std::bit_width(count) >= max_depth) return halve(range);
    const Bins bins(range);
    const Plane plane = bins.cheapest_plane();
    if (!std::isfinite(plane.cost)) return halve(range);
    const Halves halves = halves_of(range, bins.left(plane), bins.right(plane));
    size_t left = 0, right = halves[0].primitives.size();
    for (const Primitive& primitive : range.primitives) {  // branch-free: the branch would be mispredicted
        const bool is_left = bins.is_left(primitive, plane);
        range.room[is_left ? left : right] = primitive;
        left += is_left;
        right += !is_left;
    }
    return halves;
}

// Up to four ranges.
struct Children {
    std::array<Range, 4> ranges;
    size_t count = 1;
};

// The children of a node that covers `range`: splits the largest until there are four or all are leaves.
Children open(const Range& range) {
    Children children{{range}};
    std::array<bool, 4> is_leaf{};
    const auto rank = [&](size_t i) {
        return std::tuple(!is_leaf[i], children.ranges[i].area, children.ranges[i].primitives.size());
    };
    while (children.count < 4) {
        size_t largest = 0;
        for (size_t i = 1; i < children.count; ++i)
            if (rank(i) > rank(largest)) largest = i;
        if (is_leaf[largest]) break;
        if (const auto halves = split(children.ranges[largest])) {
            children.ranges[largest] = (*halves)[0];
            children.ranges[children.count++] = (*halves)[1];
        } else {
            is_leaf[largest] = true;
        }
    }
    return children;
}

// A node with its children's bounds, but without references to them.
BvhNode make_node(const Children& children) {
    BvhNode node{};
    for (size_t slot = 0; slot < 4; ++slot) {
        vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
        if (slot < children.count && !children.ranges[slot].primitives.empty()) {
            const Box& box = children.ranges[slot].box;
            low = {box.low[0], box.low[1], box.low[2]};
            high = {box.high[0], box.high[1], box.high[2]};
            const vec3 largest = glm::max(glm::abs(low), glm::abs(high));
            const float padding = bvh_padding * std::max({largest.x, largest.y, largest.z});
            low -= padding, high += padding;
        }
        for (int axis = 0; axis < 3; ++axis) {
            node.bounds[axis][0][slot] = low[axis];
            node.bounds[axis][1][slot] = high[axis];
        }
    }
    return node;
}

struct Subtree {
    uint32_t reference = 0;
    uint32_t stack_entries = 0;  // most entries that a traversal leaves on the stack on its way down
};

class Builder {
  public:
    explicit Builder(size_t triangle_count) : order(triangle_count), task_size_(std::max<size_t>(32'768, triangle_count / 64)) {}

    // Appends the node with these children and everything below it, depth first, whatever the number of threads.
    Subtree add_node(const Children& children, LargeArray<BvhNode>& nodes) {
        const size_t index = nodes.size();
        nodes.push_back(make_node(children));
        std::array<Subtree, 4> below;
        const auto has_tasks = [&](const Range& range) { return range.primitives.size() > task_size_; };
        if (std::ranges::any_of(children.ranges.begin(), children.ranges.begin() + children.count, has_tasks)) {
            std::array<LargeArray<BvhNode>, 4> parts;
            in_parallel(children.count, 1, [&](size_t slot, size_t) {
                parts[slot].reserve(children.ranges[slot].primitives.size() / 2);
                below[slot] = add(children.ranges[slot], parts[slot]);
            });
            for (size_t slot = 0; slot < children.count; ++slot) {
                const auto part = std::move(parts[slot]);  // frees its memory right away
                const auto offset = static_cast<uint32_t>(nodes.size());
                const auto move = [&](uint32_t& reference) {
                    if (!is_bvh_leaf(reference) && reference != 0) reference += offset;
                };
                if (!part.empty()) below[slot].reference += offset;
                for (BvhNode node : part) {
                    std::ranges::for_each(node.children, move);
                    nodes.push_back(node);
                }
            }
        } else {
            for (size_t slot = 0; slot < children.count; ++slot) below[slot] = add(children.ranges[slot], nodes);
        }
        uint32_t most = 0;
        for (size_t slot = 0; slot < children.count; ++slot) {
            nodes[index].children[slot] = below[slot].reference;
            most = std::max(most, below[slot].stack_entries);
        }
        return {static_cast<uint32_t>(index), most + static_cast<uint32_t>(children.count) - 1};
    }

    LargeArray<uint32_t> order;  // of the triangles

  private:
    Subtree add(const Range& range, LargeArray<BvhNode>& nodes) {
        const Children children = open(range);
        if (children.count > 1) return add_node(children, nodes);
        for (size_t i = 0; i < range.primitives.size(); ++i) order[range.first + i] = range.primitives[i].triangle();
        return {static_cast<uint32_t>(range.primitives.size() << bvh_leaf_shift | range.first), 0};
    }

    size_t task_size_;  // triangles in a subtree that one thread builds
};

}  // namespace

Bvh build_bvh(std::span<const BvhTriangle> triangles) {
    const auto start = Clock::now();
    const size_t count = triangles.size();
    constexpr size_t piece = 1 << 14;
    const auto memory = std::make_unique_for_overwrite<Primitive[]>(2 * count);
    std::vector<Box> boxes((count + piece - 1) / piece);
    in_parallel(count, piece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const BvhTriangle& triangle = triangles[i];
            const float id = std::bit_cast<float>(static_cast<uint32_t>(i) | Primitive::id_bits);
            Box box;
            for (int k = 0; k < 3; ++k) {
                const Float4 vertex{triangle.x[k], triangle.y[k], triangle.z[k], id};
                box.add({vertex, vertex});
            }
            memory[i] = {box.low, box.high};
            boxes[begin / piece].add(box);
        }
    });
    Box box;
    for (const Box& of_piece : boxes) box.add(of_piece);

    Bvh result;
    Builder builder(count);
    result.nodes.reserve(count / 2);
    const Children children = open({{memory.get(), count}, memory.get() + count, box, 0, 0});
    result.max_stack_entries = builder.add_node(children, result.nodes).stack_entries + 1;
    result.triangles.resize(count);
    in_parallel(count, piece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) result.triangles[i] = triangles[builder.order[i]];
    });
    result.build_seconds = seconds_since(start);
    return result;
}

// The triangle test multiplies two coordinates.
static constexpr float largest_coordinate = 1e18f;

uint64_t countable_triangles(const Scene& scene) {
    const uint64_t count = instanced_triangle_count(scene);
    if (count > max_triangle_count)
        throw UserError(scene.file.string() + ": its instances have " + std::to_string(count) +
                        " triangles together, more than 2^28 - 1; remove instances or use another backend");
    return count;
}

LargeArray<BvhTriangle> world_triangles(const Scene& scene) {
    LargeArray<BvhTriangle> triangles(countable_triangles(scene));
    size_t first = 0;  // of the instance
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance) {
        const glm::dmat4x3 object_to_world(scene.instances[instance].object_to_world);
        const auto world = [&](uint32_t position) {
            const vec3 result(object_to_world * glm::dvec4(scene.positions[position], 1));
            if (!glm::all(glm::lessThanEqual(glm::abs(result), vec3(largest_coordinate))))
                throw UserError(scene.file.string() + ": instance " + std::to_string(instance) +
                                " has coordinates beyond 1e18 in the world; scale it down");
            return result;
        };
        const Mesh& mesh = scene.mesh_of(instance);
        in_parallel(mesh.triangle_count, 1 << 14, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const auto triangle = static_cast<uint32_t>(mesh.first_triangle + i);
                const uvec3 vertices = scene.triangles[triangle];
                const mat3 rows = glm::transpose(mat3(world(vertices.x), world(vertices.y), world(vertices.z)));
                triangles[first + i] = {rows[0], instance, rows[1], triangle, rows[2], 0};
            }
        });
        first += mesh.triangle_count;
    }
    return triangles;
}

}  // namespace lab
