// Drawings of the inside view.
#pragma once
#include <imgui.h>

#include "inspection/path_recorder.h"
#include "viewer/screen.h"

namespace lab {

// The picture in user interface coordinates: framebuffer pixels divided by the scale.
struct Placement {
    explicit Placement(const Rectangle& picture);
    ImVec2 at(const vec2& image_position) const {
        const glm::vec2 position = corner + image_position * size;
        return {position.x, position.y};
    }
    glm::vec2 corner, size;
};

inline constexpr uint32_t light_path_colour = IM_COL32(255, 140, 40, 255);

// Draws a path over the picture: rays in blue, light samples in yellow or, if occluded, grey; the chosen vertex is highlighted.
// Green are collisions in a medium and the nodes of the light tree that lead to the chosen vertex's light samples, the smaller
// the brighter. The light path beside it is orange, from the lamp to where it ends; hits that the camera sees are dots of the
// same colour, for a ray to a pinhole is a single point in the picture. A lens blurs the first hit to a disc, which is drawn with
// the ray from its pixel.
void draw_path(const RecordedPath& path, const Camera& camera, size_t chosen, const Rectangle& picture);

// Draws a disc of HemisphereView times a factor, at reduced resolution for speed.
void draw_disc(const Image& picture, float scale, float width);

}  // namespace lab
