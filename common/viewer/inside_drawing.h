// What the window that looks inside the render draws.
#pragma once
#include <imgui.h>

#include "inside/path_recorder.h"
#include "viewer/screen.h"

namespace lab {

// Where the picture is in coordinates of the user interface: those of the framebuffer but for its scale.
struct Placement {
    explicit Placement(const Rectangle& picture);
    ImVec2 at(const vec2& image_position) const {
        const glm::vec2 position = corner + image_position * size;
        return {position.x, position.y};
    }
    glm::vec2 corner, size;
};

// A path over the picture: rays in blue, light samples in yellow or, where something is in between, grey. The
// chosen vertex stands out.
void draw_path(const RecordedPath& path, const Camera& camera, size_t chosen, const Rectangle& picture);

// The disc of a HemisphereView among the controls, times a factor. Coarser than the picture to be fast.
void draw_disc(const Image& picture, float scale, float width);

}  // namespace lab
