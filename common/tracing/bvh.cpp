#include "tracing/bvh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <future>
#include <optional>
#include <span>
#include <tuple>

#include "clock.h"

namespace lab {
namespace {

constexpr size_t max_bin_count = 32;
constexpr size_t max_leaf_triangles = 4;
// Where this many splits might come to lie above each other, ranges are halved instead: that bounds the stack
// of the traversal. Only triangles whose sizes fall geometrically need so many.
constexpr size_t max_depth = 64;
// Subtrees of fewer triangles are not worth a thread of their own.
constexpr size_t smallest_task = 32'768;
constexpr size_t max_tasks = 64;  // of equal size; a few more if they are not

// What the build moves around: the bounds of a triangle and where to find it.
struct Primitive {
    Bounds bounds;
    uint32_t triangle;
    vec3 centroid() const { return 0.5f * bounds.low + 0.5f * bounds.high; }
};

// Primitives side by side that become one subtree.
struct Range {
    std::span<Primitive> primitives;
    Bounds bounds;
    size_t depth = 0;
    bool is_leaf = false;
};

// Half the surface area, in double because the square of a large coordinate overflows a float.
double half_area(const Bounds& bounds) {
    const glm::dvec3 size = glm::dvec3(bounds.high) - glm::dvec3(bounds.low);
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

Bounds bounds_of(std::span<const Primitive> primitives) {
    Bounds bounds;
    for (const auto& primitive : primitives) bounds.grow(primitive.bounds);
    return bounds;
}

// Sorts centroids into bins of equal width along each axis.
struct Binning {
    int bin_count;
    vec3 low;
    vec3 bins_per_length{0};

    Binning(const Bounds& centroids, size_t primitive_count)
        : bin_count(static_cast<int>(std::min(max_bin_count, primitive_count))), low(centroids.low) {
        // An axis along which the bins have no width, or hardly any, keeps all centroids in bin 0.
        for (int axis = 0; axis < 3; ++axis) {
            const float scale = static_cast<float>(bin_count) / (centroids.high[axis] - low[axis]);
            if (std::isfinite(scale)) bins_per_length[axis] = scale;
        }
    }
    int bin(const Primitive& primitive, int axis) const {
        const float position = (primitive.centroid()[axis] - low[axis]) * bins_per_length[axis];
        return std::min(static_cast<int>(position), bin_count - 1);
    }
};

struct Plane {
    int axis = 0;
    int first_right_bin = 0;
    double cost = std::numeric_limits<double>::infinity();  // area times triangles, added over both sides
};

// The plane between two bins with the least surface area cost.
Plane cheapest_plane(std::span<const Primitive> primitives, const Binning& binning) {
    struct Bin {
        Bounds bounds;
        size_t count = 0;
    };
    std::array<std::array<Bin, max_bin_count>, 3> bins;
    for (const auto& primitive : primitives)
        for (int axis = 0; axis < 3; ++axis) {
            Bin& bin = bins[axis][binning.bin(primitive, axis)];
            bin.bounds.grow(primitive.bounds);
            ++bin.count;
        }
    Plane best;
    for (int axis = 0; axis < 3; ++axis) {
        // right_cost[i] belongs to bins i, i + 1, ... A side without triangles makes no split.
        std::array<double, max_bin_count> right_cost;
        Bin side;
        for (int i = binning.bin_count - 1; i > 0; --i) {
            side.bounds.grow(bins[axis][i].bounds);
            side.count += bins[axis][i].count;
            right_cost[i] = half_area(side.bounds) * static_cast<double>(side.count);
        }
        side = {};
        for (int i = 1; i < binning.bin_count; ++i) {
            side.bounds.grow(bins[axis][i - 1].bounds);
            side.count += bins[axis][i - 1].count;
            if (side.count == 0 || side.count == primitives.size()) continue;
            const double cost = half_area(side.bounds) * static_cast<double>(side.count) + right_cost[i];
            if (cost < best.cost) best = {axis, i, cost};
        }
    }
    return best;
}

// The two halves of a range, or nothing where a leaf is cheaper. A node costs as much as a triangle.
std::optional<std::array<Range, 2>> split(const Range& range) {
    const auto primitives = range.primitives;
    if (primitives.size() < 2) return {};
    Bounds centroids;
    for (const auto& primitive : primitives) centroids.grow(primitive.centroid());
    const Binning bins(centroids, primitives.size());
    Plane plane;
    if (range.depth + std::bit_width(primitives.size()) < max_depth) plane = cheapest_plane(primitives, bins);
    const double area = half_area(range.bounds);
    const double leaf_cost = area * static_cast<double>(primitives.size());
    if (primitives.size() <= max_leaf_triangles && !(area + plane.cost < leaf_cost)) return {};

    auto middle = primitives.begin() + primitives.size() / 2;
    if (std::isfinite(plane.cost)) {
        middle = std::partition(primitives.begin(), primitives.end(), [&](const Primitive& primitive) {
            return bins.bin(primitive, plane.axis) < plane.first_right_bin;
        });
    } else {
        // All centroids coincide, or the tree is too deep: halves along the longest axis.
        const vec3 size = centroids.high - centroids.low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        std::ranges::nth_element(primitives, middle, {},
                                 [&](const Primitive& p) { return p.centroid()[axis]; });
    }
    const std::span<Primitive> left(primitives.begin(), middle), right(middle, primitives.end());
    return {{Range{left, bounds_of(left), range.depth + 1}, Range{right, bounds_of(right), range.depth + 1}}};
}

// The children of a node that covers `range`: the largest is split until there are four or all are leaves.
std::vector<Range> open(const Range& range) {
    const auto rank = [](const Range& child) {
        return std::tuple(!child.is_leaf, half_area(child.bounds), child.primitives.size());
    };
    std::vector<Range> children{range};
    children.reserve(4);
    while (children.size() < 4) {
        Range& largest = *std::ranges::max_element(children, {}, rank);
        if (largest.is_leaf) break;
        if (const auto halves = split(largest)) {
            largest = (*halves)[0];
            children.push_back((*halves)[1]);
        } else {
            largest.is_leaf = true;
        }
    }
    return children;
}

// Nodes in depth-first order, without those below the links: other threads build them.
struct Part {
    struct Link;
    std::vector<BvhNode> nodes;
    std::vector<Link> links;
};
struct Part::Link {
    size_t node;
    size_t slot;
    std::future<Part> part;
};

// A node with the children's bounds, but without references to them.
BvhNode make_node(const std::vector<Range>& children) {
    BvhNode node{};
    for (size_t slot = 0; slot < 4; ++slot) {
        Bounds bounds{vec3(std::numeric_limits<float>::max()), vec3(std::numeric_limits<float>::lowest())};
        if (slot < children.size() && !children[slot].primitives.empty()) {
            bounds = children[slot].bounds;
            const vec3 largest = glm::max(glm::abs(bounds.low), glm::abs(bounds.high));
            const float padding = bvh_padding * std::max({largest.x, largest.y, largest.z});
            bounds = {bounds.low - padding, bounds.high + padding};
        }
        for (int axis = 0; axis < 3; ++axis) {
            node.bounds[axis][0][slot] = bounds.low[axis];
            node.bounds[axis][1][slot] = bounds.high[axis];
        }
    }
    return node;
}

class Builder {
  public:
    explicit Builder(std::span<const Primitive> primitives)
        : primitives_(primitives), task_size_(std::max(smallest_task, primitives.size() / max_tasks)) {}

    Part build(const Range& range) const {
        Part part;
        add_node(part, open(range));
        return part;
    }

  private:
    uint32_t add_node(Part& part, const std::vector<Range>& children) const {
        const size_t index = part.nodes.size();
        part.nodes.push_back(make_node(children));
        for (size_t slot = 0; slot < children.size(); ++slot) {
            const Range& child = children[slot];
            if (child.primitives.size() > task_size_) {
                part.links.push_back(
                    {index, slot, std::async(std::launch::async, &Builder::build, this, child)});
            } else {
                const uint32_t reference = add_child(part, child);  // may move part.nodes
                part.nodes[index].children[slot] = reference;
            }
        }
        return static_cast<uint32_t>(index);
    }

    uint32_t add_child(Part& part, const Range& range) const {
        const auto children = open(range);
        if (children.size() > 1) return add_node(part, children);
        const size_t first = range.primitives.data() - primitives_.data();
        return static_cast<uint32_t>(range.primitives.size() << bvh_leaf_shift | first);
    }

    std::span<const Primitive> primitives_;
    size_t task_size_;
};

// Appends the nodes of a part and of all parts that it links to.
void append(std::vector<BvhNode>& nodes, Part part) {
    const size_t offset = nodes.size();
    for (BvhNode& node : part.nodes) {
        for (uint32_t& child : node.children)
            if (child != 0 && !is_bvh_leaf(child)) child += static_cast<uint32_t>(offset);
        nodes.push_back(node);
    }
    for (auto& link : part.links) {
        nodes[offset + link.node].children[link.slot] = static_cast<uint32_t>(nodes.size());
        append(nodes, link.part.get());
    }
}

// Children follow their parents, so going backwards meets them first.
uint32_t max_stack_entries(const std::vector<BvhNode>& nodes) {
    std::vector<uint32_t> entries(nodes.size());
    for (size_t i = nodes.size(); i-- > 0;) {
        uint32_t child_count = 0;
        for (const uint32_t child : nodes[i].children) {
            if (child == 0) continue;
            ++child_count;
            if (!is_bvh_leaf(child)) entries[i] = std::max(entries[i], entries[child]);
        }
        entries[i] += std::max(child_count, 1u) - 1;
    }
    return entries[0] + 1;
}

double surface_area_cost(const std::vector<BvhNode>& nodes) {
    Bounds scene;
    double cost = 0;
    for (const auto& node : nodes)
        for (size_t slot = 0; slot < 4; ++slot) {
            const uint32_t child = node.children[slot];
            if (child == 0) continue;
            if (&node == &nodes.front()) scene.grow(node.child_bounds(slot));
            cost += half_area(node.child_bounds(slot)) * (is_bvh_leaf(child) ? child >> bvh_leaf_shift : 1);
        }
    return 1 + (cost > 0 ? cost / half_area(scene) : 0);
}

}  // namespace

Bvh build_bvh(const std::vector<BvhTriangle>& triangles) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<Primitive> primitives(triangles.size());
    for (size_t i = 0; i < triangles.size(); ++i) {
        const BvhTriangle& triangle = triangles[i];
        for (int vertex = 0; vertex < 3; ++vertex)
            primitives[i].bounds.grow({triangle.x[vertex], triangle.y[vertex], triangle.z[vertex]});
        primitives[i].triangle = static_cast<uint32_t>(i);
    }
    Bvh bvh;
    const Builder builder(primitives);
    append(bvh.nodes, builder.build({primitives, bounds_of(primitives)}));
    bvh.triangles.reserve(triangles.size());
    for (const auto& primitive : primitives) bvh.triangles.push_back(triangles[primitive.triangle]);
    bvh.max_stack_entries = max_stack_entries(bvh.nodes);
    bvh.surface_area_cost = surface_area_cost(bvh.nodes);
    bvh.build_seconds = seconds_since(start);
    return bvh;
}

}  // namespace lab
