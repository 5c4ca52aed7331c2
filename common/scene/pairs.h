// Pairs of boxes that overlap.
#pragma once
#include "scene/scene.h"

namespace lab {

inline bool overlap(const Bounds& a, const Bounds& b) {
    return glm::all(glm::lessThanEqual(a.low, b.high)) && glm::all(glm::lessThanEqual(b.low, a.high));
}

// Calls visit(i, j) for each pair of boxes a[i], b[j] that overlap within `space`, some of them several times: divides space
// until few are left.
template <typename Visit>
void for_each_overlap(const std::vector<Bounds>& a, const std::vector<Bounds>& b, const Bounds& space, const Visit& visit) {
    const auto inside = [](const std::vector<Bounds>& boxes, const std::vector<uint32_t>& from, const Bounds& part) {
        std::vector<uint32_t> found;
        for (const uint32_t i : from)
            if (overlap(boxes[i], part)) found.push_back(i);
        return found;
    };
    const auto divide = [&](const auto& self, const std::vector<uint32_t>& in_a, const std::vector<uint32_t>& in_b,
                            const Bounds& part, int depth) -> void {
        if (in_a.empty() || in_b.empty()) return;
        const vec3 size = part.high - part.low;
        const int axis = size.x > std::max(size.y, size.z) ? 0 : size.y > size.z ? 1 : 2;
        Bounds low = part, high = part;
        low.high[axis] = high.low[axis] = 0.5f * (part.low[axis] + part.high[axis]);
        const auto low_a = inside(a, in_a, low), high_a = inside(a, in_a, high), low_b = inside(b, in_b, low),
                   high_b = inside(b, in_b, high);
        // Large boxes are in both halves: then there is nothing to gain.
        const size_t pairs = in_a.size() * in_b.size(),
                     pairs_in_halves = low_a.size() * low_b.size() + high_a.size() * high_b.size();
        if (depth > 0 && pairs > 16 && 4 * pairs_in_halves < 3 * pairs) {
            self(self, low_a, low_b, low, depth - 1);
            self(self, high_a, high_b, high, depth - 1);
            return;
        }
        for (const uint32_t i : in_a)
            for (const uint32_t j : in_b)
                if (overlap(a[i], b[j])) visit(i, j);
    };
    const auto all = [](size_t count) {
        const auto indices = std::views::iota(0u, static_cast<uint32_t>(count));
        return std::vector<uint32_t>(indices.begin(), indices.end());
    };
    divide(divide, inside(a, all(a.size()), space), inside(b, all(b.size()), space), space, 24);
}

}  // namespace lab
