// The inside view: live verdict, tiles, a pixel's path, and what its points see.
#pragma once
#include "viewer/inspection.h"
#include "viewer/tile_overlay.h"

namespace lab {

class InsidePanel {
  public:
    explicit InsidePanel(const Device& device) : inspection_(device) {}

    // Draws over the picture, and a panel for the path of a selected pixel. Renders hemispheres for about so
    // many seconds. Call between Screen::begin_frame() and Screen::show().
    void draw(const Session& session, const Rectangle& picture, const Rectangle& panel, double seconds);
    int height() const;  // of the panel, in framebuffer pixels
    // Draws a section of the controls.
    void draw_controls(const Session& session);
    const Inspection& inspection() const { return inspection_; }
    void show_next_overlay() { overlay_.show_next(); }
    vec2 next_sample_button() const { return next_sample_button_; }  // for tests

  private:
    void select_clicked_pixel(const Session& session, const Rectangle& picture);
    void draw_verdict(const Session& session);
    void draw_pixel(const Session& session);
    void draw_panel(const Rectangle& panel);
    void draw_sample();
    void draw_vertices();
    void draw_hemisphere();

    Inspection inspection_;
    TileOverlay overlay_;
    std::optional<glm::uvec2> hovered_;  // pixel
    bool was_dragged_ = false;           // since the mouse button went down
    HemisphereView::Pictures pictures_;
    double pictures_samples_ = -1;
    vec2 next_sample_button_{0};
};

}  // namespace lab
