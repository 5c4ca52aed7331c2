#include "tracing/bvh.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <tuple>

#include "clock.h"
#include "parallel.h"
#include "tracing/bvh_split.h"

namespace lab {
namespace {

using bvh::half_area;
using bvh::Primitive;
using bvh::Range;

// Nodes in depth-first order, without those below the links.
struct Part {
    struct Link {
        size_t node;
        size_t slot;
        Range range;
    };
    std::vector<BvhNode> nodes;
    std::vector<Link> links;
    uint32_t root = 0;  // reference to it
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
    explicit Builder(std::span<Primitive> primitives) : primitives_(primitives), splitter_(primitives) {}

    std::vector<BvhNode> build() const {
        Part top;
        const Range all{primitives_, bvh::bounds_of(primitives_)};
        add_node(top, all, open(all));
        std::vector<Part> parts(top.links.size());
        in_parallel(parts.size(), 1,
                    [&](size_t i, size_t) { parts[i].root = add_child(parts[i], top.links[i].range); });
        std::vector<size_t> offsets{top.nodes.size()};
        for (size_t i = 0; i < parts.size(); ++i) {
            const Part::Link& link = top.links[i];
            top.nodes[link.node].children[link.slot] = moved(parts[i].root, offsets[i]);
            offsets.push_back(offsets[i] + parts[i].nodes.size());
        }
        std::vector<BvhNode> nodes = std::move(top.nodes);
        nodes.resize(offsets.back());
        in_parallel(parts.size(), 1, [&](size_t i, size_t) {
            for (size_t k = 0; k < parts[i].nodes.size(); ++k) {
                BvhNode node = parts[i].nodes[k];
                for (uint32_t& child : node.children)
                    if (child != 0) child = moved(child, offsets[i]);
                nodes[offsets[i] + k] = node;
            }
        });
        return nodes;
    }

  private:
    // A reference to a node that moves by `offset`. Leaves refer to triangles.
    static uint32_t moved(uint32_t reference, size_t offset) {
        return is_bvh_leaf(reference) ? reference : static_cast<uint32_t>(reference + offset);
    }

    // The children of a node that covers `range`: the largest is split until there are four or all are
    // leaves.
    std::vector<Range> open(const Range& range) const {
        const auto rank = [](const Range& child) {
            return std::tuple(!child.is_leaf, half_area(child.bounds), child.primitives.size());
        };
        std::vector<Range> children{range};
        children.reserve(4);
        while (children.size() < 4) {
            Range& largest = *std::ranges::max_element(children, {}, rank);
            if (largest.is_leaf) break;
            if (const auto halves = splitter_.split(largest)) {
                largest = (*halves)[0];
                children.push_back((*halves)[1]);
            } else {
                largest.is_leaf = true;
            }
        }
        return children;
    }

    // Appends the node of a range. Its children become tasks where they are the first that are small enough.
    uint32_t add_node(Part& part, const Range& range, const std::vector<Range>& children) const {
        const size_t index = part.nodes.size();
        part.nodes.push_back(make_node(children));
        for (size_t slot = 0; slot < children.size(); ++slot) {
            const size_t task_size = splitter_.task_size();
            if (range.primitives.size() > task_size && children[slot].primitives.size() <= task_size) {
                part.links.push_back({index, slot, children[slot]});
            } else {
                const uint32_t reference = add_child(part, children[slot]);  // may move part.nodes
                part.nodes[index].children[slot] = reference;
            }
        }
        return static_cast<uint32_t>(index);
    }

    uint32_t add_child(Part& part, const Range& range) const {
        const auto children = open(range);
        if (children.size() > 1) return add_node(part, range, children);
        const size_t first = range.primitives.data() - primitives_.data();
        return static_cast<uint32_t>(range.primitives.size() << bvh_leaf_shift | first);
    }

    std::span<Primitive> primitives_;
    bvh::Splitter splitter_;
};

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
    for (size_t slot = 0; slot < 4; ++slot)
        if (nodes[0].children[slot] != 0) scene.grow(nodes[0].child_bounds(slot));
    const auto cost = sum_in_parallel<double>(nodes.size(), [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t i = begin; i < end; ++i)
            for (size_t slot = 0; slot < 4; ++slot) {
                const uint32_t child = nodes[i].children[slot];
                if (child == 0) continue;
                const uint32_t visits = is_bvh_leaf(child) ? child >> bvh_leaf_shift : 1;
                sum += half_area(nodes[i].child_bounds(slot)) * visits;
            }
        return sum;
    });
    return 1 + (cost > 0 ? cost / half_area(scene) : 0);
}

}  // namespace

Bvh build_bvh(const std::vector<BvhTriangle>& triangles) {
    const auto start = std::chrono::steady_clock::now();
    constexpr size_t piece = 1 << 14;
    const size_t count = triangles.size();
    const auto primitives = std::make_unique_for_overwrite<Primitive[]>(count);
    in_parallel(count, piece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const BvhTriangle& triangle = triangles[i];
            Bounds bounds;
            for (int vertex = 0; vertex < 3; ++vertex)
                bounds.grow({triangle.x[vertex], triangle.y[vertex], triangle.z[vertex]});
            primitives[i] = Primitive(bounds, static_cast<uint32_t>(i));
        }
    });
    Bvh result;
    result.nodes = Builder({primitives.get(), count}).build();
    result.triangles.resize(count);
    in_parallel(count, piece, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) result.triangles[i] = triangles[primitives[i].triangle()];
    });
    result.max_stack_entries = max_stack_entries(result.nodes);
    result.surface_area_cost = surface_area_cost(result.nodes);
    result.build_seconds = seconds_since(start);
    return result;
}

}  // namespace lab
