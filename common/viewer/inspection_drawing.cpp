#include "viewer/inspection_drawing.h"

#include <cmath>
#include <numbers>

#include "inspection/hemisphere_view.h"
#include "inspection/projection.h"

namespace lab {
namespace {

constexpr uint32_t blue = IM_COL32(60, 200, 255, 255), collision_green = IM_COL32(120, 255, 120, 255);

// Radiance as the picture shows it at exposure 0.
uint32_t colour_of(const vec3& radiance) {
    const auto channel = [&](int i) { return std::lround(255 * linear_to_srgb(radiance[i])); };
    return IM_COL32(channel(0), channel(1), channel(2), 255);
}

// Where a lens shows the point that a camera ray hits, if that ray leaves the lens at `start`: the plane in focus is sharp, so it
// is the place of the point in which the ray crosses this plane.
std::optional<vec2> seen_through_lens(const Camera& camera, const vec3& start, const vec3& hit) {
    const float depth = glm::dot(hit - camera.position, camera.forward);
    return project(camera, start + camera.focus_distance / depth * (hit - start));
}

// The lens as the picture shows it: all its points together blur the hit to a disc. The camera ray starts at one of them.
void draw_lens(ImDrawList& list, const Placement& placement, const Camera& camera, const PathVertex& first) {
    constexpr int corners = 64;
    for (int i = 0; i < corners; ++i) {
        const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / corners;
        const vec3 rim = std::cos(angle) * glm::normalize(camera.right) + std::sin(angle) * glm::normalize(camera.up);
        const auto position = seen_through_lens(camera, camera.position + camera.aperture_radius * rim, first.position);
        if (position) list.PathLineTo(placement.at(*position));
    }
    list.PathStroke(blue, ImDrawFlags_Closed, 1);
    const auto pixel = seen_through_lens(camera, first.origin, first.position), hit = project(camera, first.position);
    if (pixel && hit) list.AddLine(placement.at(*pixel), placement.at(*hit), blue, 2);
}

// Three great circles.
template <typename DrawLine>
void draw_sphere(const Sphere& sphere, uint32_t colour, const DrawLine& draw_line) {
    constexpr int corners = 48;
    for (int axis = 0; axis < 3; ++axis) {
        const auto corner = [&](int i) {
            const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / corners;
            vec3 point = sphere.centre;
            point[axis] += sphere.radius * std::cos(angle);
            point[(axis + 1) % 3] += sphere.radius * std::sin(angle);
            return point;
        };
        for (int i = 0; i < corners; ++i) draw_line(corner(i), corner(i + 1), colour, 1.0f);
    }
}

}  // namespace

Placement::Placement(const Rectangle& picture) {
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    corner = glm::vec2(picture.corner) / glm::vec2(scale.x, scale.y);
    size = glm::vec2(picture.size) / glm::vec2(scale.x, scale.y);
}

void draw_path(const RecordedPath& path, const Camera& camera, size_t chosen, const Rectangle& picture) {
    const Placement placement(picture);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.PushClipRect(placement.at({0, 0}), placement.at({1, 1}));
    const auto draw_line = [&](const vec3& from, const vec3& to, uint32_t colour, float width) {
        if (const auto ends = project_segment(camera, from, to))
            list.AddLine(placement.at((*ends)[0]), placement.at((*ends)[1]), colour, width);
    };
    const auto far_away = [&](const vec3& start, const vec3& direction) {
        constexpr float far = 1e3f;
        return start + far * glm::length(start - camera.position) * direction;
    };
    const auto& vertices = path.vertices;
    if (chosen < vertices.size())
        for (const LightSample& light : vertices[chosen].light_samples)
            for (size_t i = 0; i < light.branch.size(); ++i)
                draw_sphere(light.branch[i], IM_COL32(90, 230, 110, 80 + 175 * (i + 1) / light.branch.size()), draw_line);
    const auto draw_shadow_rays = [&](const std::vector<PathVertex>& of_path, uint32_t colour) {
        for (const PathVertex& vertex : of_path)
            for (const LightSample& light : vertex.light_samples)
                draw_line(light.start, light.point.value_or(far_away(light.start, light.direction)),
                          light.is_visible ? colour : IM_COL32(120, 120, 120, 200), 1);
    };
    const auto draw_ray = [&](const PathVertex& vertex, const vec3& start, uint32_t colour) {
        draw_line(start, vertex.is_in_scene() ? vertex.position : far_away(start, vertex.direction), colour, 2);
    };
    const auto draw_dot = [&](const PathVertex& vertex, const std::string& name, float radius, uint32_t colour) {
        const auto position = vertex.is_in_scene() ? project(camera, vertex.position) : std::nullopt;
        if (!position) return;
        const ImVec2 at = placement.at(*position);
        list.AddCircleFilled(at, radius, colour);
        const ImVec2 corner(at.x + 7, at.y - 0.5f * ImGui::GetFontSize()), size = ImGui::CalcTextSize(name.c_str());
        list.AddRectFilled({corner.x - 2, corner.y}, {corner.x + size.x + 2, corner.y + size.y}, IM_COL32(0, 0, 0, 160));
        list.AddText(corner, colour, name.c_str());
    };
    draw_shadow_rays(path.light_path, light_path_colour);
    for (size_t i = 0; i < path.light_path.size(); ++i) {
        const PathVertex& vertex = path.light_path[i];
        draw_ray(vertex, vertex.parent < 0 ? vertex.origin : path.light_path[static_cast<size_t>(vertex.parent)].position,
                 light_path_colour);
        draw_dot(vertex, "y" + std::to_string(i + 1), 4, light_path_colour);
    }
    draw_shadow_rays(vertices, IM_COL32(255, 220, 60, 200));
    for (const PathVertex& vertex : vertices) {
        if (vertex.parent < 0) {  // a pinhole's own ray is a single point in the picture
            if (camera.aperture_radius > 0 && vertex.is_in_scene()) draw_lens(list, placement, camera, vertex);
            continue;
        }
        draw_ray(vertex, vertices[static_cast<size_t>(vertex.parent)].position, blue);
    }
    for (size_t i = 0; i < vertices.size(); ++i) {
        const uint32_t colour = i == chosen ? IM_COL32(255, 80, 200, 255) : vertices[i].is_collision ? collision_green : blue;
        draw_dot(vertices[i], "x" + std::to_string(i + 1), i == chosen ? 6.0f : 4.0f, colour);
    }
    list.PopClipRect();
}

void draw_disc(const Image& picture, float scale, float width) {
    constexpr uint32_t cells = 40, extent = HemisphereView::extent;
    const float cell = width / cells;
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (uint32_t y = 0; y < cells; ++y)
        for (uint32_t x = 0; x < cells; ++x) {
            const glm::vec2 centre = 2.0f * (glm::vec2(x, y) + 0.5f) / static_cast<float>(cells) - 1.0f;
            if (glm::dot(centre, centre) >= 1) continue;
            const glm::uvec2 first = glm::uvec2(x, y) * extent / cells, last = glm::uvec2(x + 1, y + 1) * extent / cells;
            vec3 sum(0);
            for (uint32_t py = first.y; py < last.y; ++py)
                for (uint32_t px = first.x; px < last.x; ++px)
                    for (uint32_t channel = 0; channel < 3; ++channel)
                        sum[static_cast<int>(channel)] += picture.pixels[3 * (py * extent + px) + channel];
            const vec3 mean = sum / static_cast<float>((last.x - first.x) * (last.y - first.y));
            const ImVec2 a(corner.x + cell * static_cast<float>(x), corner.y + cell * static_cast<float>(y));
            list.AddRectFilled(a, {a.x + cell, a.y + cell}, colour_of(scale * mean));
        }
    ImGui::Dummy({cell * cells, cell * cells});
}

}  // namespace lab
