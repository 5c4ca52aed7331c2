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

using bvh::Extent;
using bvh::Primitive;
using bvh::Range;

constexpr size_t smallest_task = 32'768;  // less is not worth sharing
constexpr size_t max_tasks = 64;          // of equal size; a few more if they are not

// Nodes in depth-first order, without those below the links.
struct Part {
    struct Link {
        size_t node;
        size_t slot;
        Range range;
    };
    std::vector<BvhNode> nodes;
    std::vector<Link> links;
    uint32_t root = 0;           // reference to it
    uint32_t stack_entries = 0;  // most that a traversal leaves behind on its way down
};

// Up to four ranges.
struct Children {
    std::array<Range, 4> ranges;
    size_t count;
};

// A node with the children's bounds, but without references to them.
BvhNode make_node(std::span<const Range> children) {
    BvhNode node{};
    for (size_t slot = 0; slot < 4; ++slot) {
        Bounds bounds{vec3(std::numeric_limits<float>::max()), vec3(std::numeric_limits<float>::lowest())};
        if (slot < children.size() && !children[slot].primitives.empty()) {
            bounds = children[slot].box.bounds();
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

// Counts the entries of a part, with those below its links. Children follow their parents, so going backwards
// meets them first.
void count_stack_entries(Part& part, std::span<const Part> below) {
    std::vector<uint32_t> entries(part.nodes.size());
    for (size_t i = 0; i < below.size(); ++i) {
        uint32_t& most = entries[part.links[i].node];
        most = std::max(most, below[i].stack_entries);
    }
    for (size_t i = part.nodes.size(); i-- > 0;) {
        uint32_t child_count = 0;
        for (const uint32_t child : part.nodes[i].children) {
            child_count += child != 0;
            if (child != 0 && child < part.nodes.size()) entries[i] = std::max(entries[i], entries[child]);
        }
        entries[i] += std::max(child_count, 1u) - 1;
    }
    if (!entries.empty()) part.stack_entries = entries[0];
}

class Builder {
  public:
    Builder(std::span<const BvhTriangle> triangles, Bvh& result)
        : triangles_(triangles),
          result_(result),
          order_(triangles.size()),
          task_size_(std::max(smallest_task, triangles.size() / max_tasks)) {}

    void build() {
        const size_t count = triangles_.size();
        const auto memory = std::make_unique_for_overwrite<Primitive[]>(2 * count);
        const std::span primitives(memory.get(), count);
        const Extent extent = fill(primitives);
        Range all{primitives, memory.get() + count, extent.box, extent.places, extent.box.half_area()};
        const bvh::LargeRanges large(all, task_size_ / 4);  // all that the nodes above the tasks split
        Part top;
        add_node(top, all, open(all));
        std::vector<Part> parts(top.links.size());
        in_parallel(parts.size(), 1, [&](size_t i, size_t) {
            const Range& range = top.links[i].range;
            parts[i].nodes.reserve(range.primitives.size() / 2);
            parts[i].root = add_child(parts[i], range);
            count_stack_entries(parts[i], {});
        });
        std::vector<size_t> offsets{top.nodes.size()};
        for (size_t i = 0; i < parts.size(); ++i) {
            const Part::Link& link = top.links[i];
            top.nodes[link.node].children[link.slot] = moved(parts[i].root, offsets[i]);
            offsets.push_back(offsets[i] + parts[i].nodes.size());
        }
        count_stack_entries(top, parts);
        result_.max_stack_entries = top.stack_entries + 1;
        result_.nodes.resize(offsets.back());
        std::ranges::copy(top.nodes, result_.nodes.begin());
        in_parallel(parts.size(), 1, [&](size_t i, size_t) {
            const auto nodes = std::move(parts[i].nodes);  // their memory goes back at once
            for (size_t k = 0; k < nodes.size(); ++k) {
                BvhNode node = nodes[k];
                for (uint32_t& child : node.children)
                    if (child != 0) child = moved(child, offsets[i]);
                result_.nodes[offsets[i] + k] = node;
            }
        });
        result_.triangles.resize(count);
        in_parallel(count, piece, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) result_.triangles[i] = triangles_[order_[i]];
        });
    }

  private:
    // Makes the primitives of all triangles.
    Extent fill(std::span<Primitive> primitives) const {
        std::vector<Extent> extents((primitives.size() + piece - 1) / piece);
        in_parallel(primitives.size(), piece, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const BvhTriangle& triangle = triangles_[i];
                Bounds bounds;
                for (int vertex = 0; vertex < 3; ++vertex)
                    bounds.grow({triangle.x[vertex], triangle.y[vertex], triangle.z[vertex]});
                primitives[i] = Primitive(bounds, static_cast<uint32_t>(i));
                extents[begin / piece].add(primitives[i]);
            }
        });
        Extent all;
        for (const Extent& extent : extents) all.add(extent);
        return all;
    }

    // A reference to a node that moves by `offset`. Leaves refer to triangles.
    static uint32_t moved(uint32_t reference, size_t offset) {
        return is_bvh_leaf(reference) ? reference : static_cast<uint32_t>(reference + offset);
    }

    // The children of a node that covers `range`: the largest is split until there are four or all are
    // leaves.
    static Children open(const Range& range) {
        Children children;
        children.ranges[0] = range;
        children.count = 1;
        std::array<bool, 4> is_leaf{};
        const auto rank = [&](size_t i) {
            return std::tuple(!is_leaf[i], children.ranges[i].area, children.ranges[i].primitives.size());
        };
        while (children.count < 4) {
            size_t largest = 0;
            for (size_t i = 1; i < children.count; ++i)
                if (rank(i) > rank(largest)) largest = i;
            if (is_leaf[largest]) break;
            if (const auto halves = bvh::split(children.ranges[largest])) {
                children.ranges[largest] = (*halves)[0];
                children.ranges[children.count++] = (*halves)[1];
            } else {
                is_leaf[largest] = true;
            }
        }
        return children;
    }

    // Appends the node of a range. Its children become tasks where they are the first that are small enough.
    uint32_t add_node(Part& part, const Range& range, const Children& children) {
        const size_t index = part.nodes.size();
        part.nodes.push_back(make_node({children.ranges.data(), children.count}));
        for (size_t slot = 0; slot < children.count; ++slot) {
            const Range& child = children.ranges[slot];
            if (range.primitives.size() > task_size_ && child.primitives.size() <= task_size_) {
                part.links.push_back({index, slot, child});
            } else {
                const uint32_t reference = add_child(part, child);  // may move part.nodes
                part.nodes[index].children[slot] = reference;
            }
        }
        return static_cast<uint32_t>(index);
    }

    uint32_t add_child(Part& part, const Range& range) {
        const Children children = open(range);
        if (children.count > 1) return add_node(part, range, children);
        for (size_t i = 0; i < range.primitives.size(); ++i)
            order_[range.first + i] = range.primitives[i].triangle();
        return static_cast<uint32_t>(range.primitives.size() << bvh_leaf_shift | range.first);
    }

    static constexpr size_t piece = 1 << 14;

    std::span<const BvhTriangle> triangles_;
    Bvh& result_;
    LargeArray<uint32_t> order_;  // of the triangles
    size_t task_size_;
};

}  // namespace

Bvh build_bvh(std::span<const BvhTriangle> triangles) {
    const auto start = std::chrono::steady_clock::now();
    Bvh result;
    Builder(triangles, result).build();
    result.build_seconds = seconds_since(start);
    return result;
}

}  // namespace lab
