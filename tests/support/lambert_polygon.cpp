#include "support/lambert_polygon.h"

#include <cmath>

namespace lab {

using glm::dvec3;

// The part of the polygon with n·x > 0 (Sutherland and Hodgman, Communications of the ACM 17(1), 1974).
static std::vector<dvec3> clip_at_horizon(const std::vector<dvec3>& corners, const dvec3& normal) {
    std::vector<dvec3> clipped;
    for (size_t i = 0; i < corners.size(); ++i) {
        const dvec3 a = corners[i], b = corners[(i + 1) % corners.size()];
        const double height_a = glm::dot(normal, a), height_b = glm::dot(normal, b);
        if (height_a > 0) clipped.push_back(a);
        if ((height_a > 0) != (height_b > 0)) clipped.push_back(a + height_a / (height_a - height_b) * (b - a));
    }
    return clipped;
}

double polygon_irradiance(const std::vector<dvec3>& corners, const dvec3& point, const dvec3& normal) {
    std::vector<dvec3> from_point;
    for (const dvec3& corner : corners) from_point.push_back(corner - point);
    const dvec3 front = glm::cross(from_point[1] - from_point[0], from_point[2] - from_point[0]);
    if (glm::dot(front, from_point[0]) >= 0) return 0;
    const std::vector<dvec3> visible = clip_at_horizon(from_point, normal);
    // E = 1/2 sum of Θ Γ·n over the edges: Θ is the edge's angle as seen from the point, Γ the unit normal of the plane through
    // both. a × b is computed as a × (b - a), so nothing cancels.
    double sum = 0;
    for (size_t i = 0; i < visible.size(); ++i) {
        const dvec3 a = visible[i], b = visible[(i + 1) % visible.size()];
        const dvec3 cross = glm::cross(a, b - a);
        const double length = glm::length(cross);
        // An edge that points to x subtends no angle.
        if (length > 0) sum += std::atan2(length, glm::dot(a, b)) * glm::dot(cross / length, normal);
    }
    return 0.5 * std::abs(sum);
}

}  // namespace lab
