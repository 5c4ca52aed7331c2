// A chapter's window: shows the picture while it renders, and lets the user change everything.
#pragma once
#include <algorithm>

#include "clock.h"
#include "viewer/camera_control.h"
#include "viewer/comparison.h"
#include "viewer/controls.h"
#include "viewer/inspection_panel.h"
#include "viewer/screen.h"
#include "viewer/session.h"

namespace lab {

class Viewer {
  public:
    // Window and device (made for this window) must outlive the viewer. Throws like make_build().
    Viewer(Window& window, const Device& device, const Chapter& chapter, const RenderJob& job);

    // Handles input, renders and shows one frame. Returns false once the window is closed.
    bool frame();

    Session& session() { return session_; }
    Screen& screen() { return screen_; }
    const Controls& controls() const { return controls_; }
    const InspectionPanel& inspection_panel() const { return inspection_panel_; }
    Comparison& comparison() { return comparison_; }
    Rectangle picture_rectangle() const;  // in the window
    Rectangle path_rectangle() const;     // panel below for the selected path; of height 0 without one
    Rectangle controls_rectangle() const;

  private:
    bool is_narrow() const;  // too narrow for controls beside the picture: they are below
    void move_camera(double seconds);
    void handle_keys();

    Window& window_;
    Screen screen_;
    Session session_;
    CameraControl camera_control_;
    std::shared_ptr<const Scene> fitted_scene_;  // that the camera's speed was adapted to
    Controls controls_;
    InspectionPanel inspection_panel_;
    Comparison comparison_;
    bool shows_controls_ = true;
    double interface_seconds_ = 0.01;  // per frame, smoothed
    double frames_per_second_ = 0;     // smoothed
    Clock::time_point last_frame_ = Clock::now();
    Clock::time_point last_motion_{};
};

// Renders until the window is closed, then writes the outputs. If the device is lost, writes the last snapshot and throws
// DeviceFailure.
void run_viewer(Window& window, const Device& device, const Chapter& chapter, const RenderJob& job);

// Seconds of a frame to spend on rendering, given the seconds of everything else except waiting. A fast device fills the
// display's period. With a slow interface, as on a CPU, frames get longer so that most of the time goes into the picture, but not
// below 5 frames per second if the interface allows.
inline double rendering_seconds(double refresh_seconds, double interface_seconds) {
    constexpr double slowest_frame = 0.16;  // leaves room for blocks that take longer than expected
    constexpr double shortest = 0.002;
    const double frame = std::clamp(4 * interface_seconds, refresh_seconds, std::max(refresh_seconds, slowest_frame));
    return std::max(frame - interface_seconds, shortest);
}

}  // namespace lab
