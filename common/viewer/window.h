// A window on the desktop, by GLFW.
#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "shaders/interface.h"

struct GLFWwindow;

namespace lab {

class Window {
  public:
    // Throws UserError if no window can be opened. Only one may exist at a time.
    Window(const std::string& title, uvec2 size);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    // Instance extensions that a device needs to present to this window.
    std::vector<const char*> instance_extensions() const;
    VkSurfaceKHR make_surface(VkInstance instance) const;

    GLFWwindow* handle() const { return window_; }
    uvec2 framebuffer_size() const;  // pixels; 0 while the window is minimised
    float scale() const;             // factor by which text has to be larger than on a common screen
    double refresh_seconds() const;  // between two refreshes of the display
    bool should_close() const;

    // Collects events, waiting for them at most this long.
    void poll_events(double max_wait_seconds = 0);
    void clear_events();                                                  // after they have been handled
    bool is_key_down(int key) const { return keys_down_.contains(key); }  // GLFW_KEY_...
    bool was_key_pressed(int key) const { return keys_pressed_.contains(key); }
    // Files dropped onto the window.
    const std::vector<std::filesystem::path>& dropped_files() const { return dropped_files_; }

  private:
    void install_callbacks();

    GLFWwindow* window_ = nullptr;
    std::set<int> keys_down_, keys_pressed_;
    std::vector<std::filesystem::path> dropped_files_;
};

}  // namespace lab
