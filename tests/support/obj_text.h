// The text of .obj files.
#pragma once
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace lab {

// A convex body. The corners of its faces go counter-clockwise when they are seen from outside.
struct Solid {
    std::vector<glm::vec3> corners;
    std::vector<std::vector<int>> faces;
};

inline Solid make_box(const glm::vec3& low, const glm::vec3& high) {
    Solid box{{}, {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (int i = 0; i < 8; ++i) box.corners.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    return box;
}

// A ball of 48 triangles that fits into a box, whose poles touch it.
inline Solid make_ball(const glm::vec3& low, const glm::vec3& high) {
    constexpr int rings = 3, segments = 8;
    const glm::vec3 centre = 0.5f * (low + high), radii = 0.5f * (high - low);
    Solid ball{{{centre.x, low.y, centre.z}, {centre.x, high.y, centre.z}}, {}};
    const auto corner = [](int ring, int segment) { return 2 + ring * segments + segment % segments; };
    for (int ring = 0; ring < rings; ++ring)
        for (int segment = 0; segment < segments; ++segment) {
            const float theta = 3.14159265f * static_cast<float>(ring + 1) / (rings + 1);
            const float phi = 6.2831853f * static_cast<float>(segment) / segments;
            const glm::vec3 direction(std::sin(theta) * std::sin(phi), -std::cos(theta), std::sin(theta) * std::cos(phi));
            ball.corners.push_back(centre + radii * direction);
        }
    for (int i = 0; i < segments; ++i) {
        ball.faces.push_back({0, corner(0, i + 1), corner(0, i)});
        ball.faces.push_back({1, corner(rings - 1, i), corner(rings - 1, i + 1)});
        for (int ring = 0; ring + 1 < rings; ++ring) {
            ball.faces.push_back({corner(ring, i), corner(ring, i + 1), corner(ring + 1, i + 1)});
            ball.faces.push_back({corner(ring, i), corner(ring + 1, i + 1), corner(ring + 1, i)});
        }
    }
    return ball;
}

// The corners and faces of a body whose first corner has this index, counted from 1.
inline std::string obj_text(const Solid& solid, int first = 1, bool is_inside_out = false) {
    std::string text;
    for (const glm::vec3& corner : solid.corners)
        text += "v " + std::to_string(corner.x) + " " + std::to_string(corner.y) + " " + std::to_string(corner.z) + "\n";
    for (const std::vector<int>& face : solid.faces) {
        text += "f";
        for (size_t i = 0; i < face.size(); ++i)
            text += " " + std::to_string(first + face[is_inside_out ? face.size() - 1 - i : i]);
        text += "\n";
    }
    return text;
}

inline std::string box_text(const glm::vec3& low, const glm::vec3& high, int first = 1, bool is_inside_out = false) {
    return obj_text(make_box(low, high), first, is_inside_out);
}

}  // namespace lab
