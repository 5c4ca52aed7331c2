// The text of .obj files.
#pragma once
#include <array>
#include <glm/glm.hpp>
#include <string>

namespace lab {

// The corners and faces of a box whose first corner has this index, counted from 1. Its fronts face outwards unless it is inside
// out.
inline std::string box_text(const glm::vec3& low, const glm::vec3& high, int first = 1, bool is_inside_out = false) {
    std::string text;
    for (int i = 0; i < 8; ++i)
        text += "v " + std::to_string(i & 1 ? high.x : low.x) + " " + std::to_string(i & 2 ? high.y : low.y) + " " +
                std::to_string(i & 4 ? high.z : low.z) + "\n";
    for (const auto& face : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
        text += "f";
        for (size_t i = 0; i < 4; ++i) text += " " + std::to_string(first + face[is_inside_out ? 3 - i : i]);
        text += "\n";
    }
    return text;
}

}  // namespace lab
