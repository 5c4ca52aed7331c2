// The window of a chapter: shows the picture while it is rendered, and lets its user change everything.
#pragma once
#include <algorithm>

#include "clock.h"
#include "viewer/camera_control.h"
#include "viewer/comparison.h"
#include "viewer/controls.h"
#include "viewer/inside_panel.h"
#include "viewer/screen.h"
#include "viewer/session.h"

namespace lab {

class Viewer {
  public:
    // Window and device (made for this window) must outlive the viewer. Throws what a first render would
    // throw.
    Viewer(Window& window, const Device& device, const Chapter& chapter, const RenderJob& job);

    // Handles what the user did, renders for a part of a frame's time and shows the result. False once the
    // window is closed.
    bool frame();

    Session& session() { return session_; }
    Screen& screen() { return screen_; }
    const Controls& controls() const { return controls_; }
    const InsidePanel& inside_panel() const { return inside_panel_; }
    Comparison& comparison() { return comparison_; }
    Rectangle picture_rectangle() const;  // where the window shows the picture
    Rectangle path_rectangle() const;     // below it: the path that is looked into; of no height without one

  private:
    void move_camera(double seconds);
    void handle_keys();

    Window& window_;
    Screen screen_;
    Session session_;
    CameraControl camera_control_;
    std::shared_ptr<const Scene> fitted_scene_;  // that the camera's speed fits to
    Controls controls_;
    InsidePanel inside_panel_;
    Comparison comparison_;
    bool shows_controls_ = true;
    double interface_seconds_ = 0.01;  // of a frame, smoothed
    double frames_per_second_ = 0;     // smoothed
    Clock::time_point last_frame_ = Clock::now();
    Clock::time_point last_motion_{};
};

// Opens the window and renders until it is closed; then writes the outputs that the options name, as a run
// without a window does. Throws DeviceFailure if the device is lost, after writing what was last read from
// it.
void run_viewer(Window& window, const Device& device, const Chapter& chapter, const RenderJob& job);

// Seconds of a frame that rendering may take, after frames that took `interface_seconds` for everything else
// but waiting. A fast device fills what is left of the display's period. Where the interface itself is slow,
// as on a CPU, a frame takes longer than a period, so that most of the time goes into the picture, but not so
// long that there are fewer than 5 frames a second, while the interface leaves that choice.
inline double rendering_seconds(double refresh_seconds, double interface_seconds) {
    constexpr double slowest_frame = 0.16;  // leaves some room for blocks that take longer than expected
    constexpr double shortest = 0.002;
    const double frame =
        std::clamp(4 * interface_seconds, refresh_seconds, std::max(refresh_seconds, slowest_frame));
    return std::max(frame - interface_seconds, shortest);
}

}  // namespace lab
