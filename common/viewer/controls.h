// The panel on the left of the window.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "viewer/camera_control.h"
#include "viewer/screen.h"
#include "viewer/session.h"

namespace lab {

class Controls {
  public:
    // Call between Screen::begin_frame() and Screen::show(). `further` draws more sections of the panel.
    void draw(Session& session, CameraControl& camera_control, const Rectangle& where, double frames_per_second,
              const std::function<void()>& further);
    int width() const;                                 // beside the picture, in framebuffer pixels
    vec2 seed_field() const { return seed_field_; }    // for tests
    vec2 lobes_box() const { return lobes_box_; }      // for tests
    vec2 focus_field() const { return focus_field_; }  // for tests

  private:
    void draw_actions(Session& session);
    void draw_scene(Session& session, Options& options);
    void draw_paths(const Chapter& chapter, const RenderParameters& parameters, Options& options);
    void draw_camera(Session& session, CameraControl& camera_control);
    void save(Session& session, const char* ending);

    const std::vector<std::filesystem::path> scenes_ = shipped_scenes();
    std::string notice_;  // the latest action
    vec2 seed_field_{0}, lobes_box_{0}, focus_field_{0};
};

}  // namespace lab
