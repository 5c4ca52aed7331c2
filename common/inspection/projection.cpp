#include "inspection/projection.h"

namespace lab {

std::optional<vec2> project(const Camera& camera, const vec3& point) {
    const vec3 to_point = point - camera.position;
    const float depth = glm::dot(to_point, camera.forward);
    if (!(depth > 0)) return std::nullopt;
    const vec2 position(glm::dot(to_point, camera.right) / glm::dot(camera.right, camera.right),
                        -glm::dot(to_point, camera.up) / glm::dot(camera.up, camera.up));
    return 0.5f + 0.5f * position / depth;
}

std::optional<std::array<vec2, 2>> project_segment(const Camera& camera, vec3 from, vec3 to) {
    const float depth_from = glm::dot(from - camera.position, camera.forward),
                depth_to = glm::dot(to - camera.position, camera.forward);
    // Depth of a near plane, scaled with the segment's depth.
    const float nearest = 1e-3f * std::max(depth_from, depth_to);
    if (!(nearest > 0)) return std::nullopt;
    const auto cut = [&](vec3& end, float depth_end, const vec3& other, float depth_other) {
        if (depth_end < nearest) end = glm::mix(other, end, (depth_other - nearest) / (depth_other - depth_end));
    };
    cut(from, depth_from, to, depth_to);
    cut(to, depth_to, from, depth_from);
    const auto a = project(camera, from), b = project(camera, to);
    if (!a || !b) return std::nullopt;
    return std::array{*a, *b};
}

}  // namespace lab
