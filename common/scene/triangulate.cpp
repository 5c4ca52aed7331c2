#include "scene/triangulate.h"

#include <algorithm>
#include <numeric>

namespace lab {
namespace {

using glm::dvec2;
using glm::dvec3;

// Twice the signed area of a triangle: positive if counter-clockwise.
double area(const dvec2& a, const dvec2& b, const dvec2& c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// Projects the polygon along the axis closest to its normal, so that it is counter-clockwise.
std::vector<dvec2> project(std::span<const vec3> polygon) {
    const dvec3 origin(polygon[0]);
    dvec3 normal(0);  // sum over a fan: also right for concave polygons
    for (size_t i = 1; i + 1 < polygon.size(); ++i)
        normal += glm::cross(dvec3(polygon[i]) - origin, dvec3(polygon[i + 1]) - origin);
    const dvec3 size = glm::abs(normal);
    const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    std::vector<dvec2> points;
    for (const vec3& corner : polygon) {
        const dvec3 p = dvec3(corner) - origin;
        points.emplace_back(p[(axis + 1) % 3], normal[axis] < 0 ? -p[(axis + 2) % 3] : p[(axis + 2) % 3]);
    }
    return points;
}

}  // namespace

std::vector<std::array<uint32_t, 3>> triangulate(std::span<const vec3> polygon) {
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<uint32_t> rest(polygon.size());
    std::iota(rest.begin(), rest.end(), 0u);
    const std::vector<dvec2> points = polygon.size() > 3 ? project(polygon) : std::vector<dvec2>();
    while (rest.size() > 3) {
        // An ear is a convex corner whose triangle contains no other corner. Every polygon has one; if rounding or crossing edges
        // hide it, any corner will do.
        size_t ear = 1;
        for (size_t i = 1; i <= rest.size(); ++i) {
            const uint32_t a = rest[i - 1], b = rest[i % rest.size()], c = rest[(i + 1) % rest.size()];
            if (area(points[a], points[b], points[c]) <= 0) continue;
            const bool is_ear = std::ranges::none_of(rest, [&](uint32_t p) {
                return points[p] != points[a] && points[p] != points[b] && points[p] != points[c] &&
                       area(points[a], points[b], points[p]) >= 0 && area(points[b], points[c], points[p]) >= 0 &&
                       area(points[c], points[a], points[p]) >= 0;
            });
            if (is_ear) {
                ear = i % rest.size();
                break;
            }
        }
        const size_t count = rest.size();
        triangles.push_back({rest[(ear + count - 1) % count], rest[ear], rest[(ear + 1) % count]});
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    triangles.push_back({rest[0], rest[1], rest[2]});
    return triangles;
}

}  // namespace lab
