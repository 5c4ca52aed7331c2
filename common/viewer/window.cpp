#include "viewer/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>

#include "error.h"
#include "platform.h"

namespace lab {
namespace {

// GLFW's last error, for messages.
std::string glfw_error() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text ? text : "GLFW does not work here";
}

// Starts GLFW. From version 3.4 on it offers a choice; by default it tries Wayland first, whether wanted or not.
bool start_glfw() {
    for ([[maybe_unused]] const WindowSystem system : window_systems()) {
#ifdef GLFW_PLATFORM
        if (system != WindowSystem::other)
            glfwInitHint(GLFW_PLATFORM, system == WindowSystem::wayland ? GLFW_PLATFORM_WAYLAND : GLFW_PLATFORM_X11);
#endif
        // GLFW 3.4 crashes on Wayland compositors without a seat, that is, without keyboard and mouse.
        if (would_survive(glfwInit) && glfwInit()) return true;
    }
    return false;
}

}  // namespace

Window::Window(const std::string& title, uvec2 size) {
    if (window_systems().empty())
        throw UserError(
            "there is no display (DISPLAY is not set, and WAYLAND_DISPLAY names none) for a window: use "
            "--headless");
    if (start_glfw() && glfwVulkanSupported()) {
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
        glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
        window_ = glfwCreateWindow(static_cast<int>(size.x), static_cast<int>(size.y), title.c_str(), nullptr, nullptr);
    }
    if (!window_) {
        const std::string why = glfw_error();
        glfwTerminate();
        throw UserError("no window can be opened (" + why + "): use --headless");
    }
    glfwSetWindowSizeLimits(window_, 320, 240, GLFW_DONT_CARE, GLFW_DONT_CARE);
    install_callbacks();
}

Window::~Window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void Window::install_callbacks() {
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
        auto& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
        if (action == GLFW_PRESS) {
            self.keys_down_.insert(key);
            self.keys_pressed_.insert(key);
        } else if (action == GLFW_RELEASE) {
            self.keys_down_.erase(key);
        }
    });
    // While this window lacks the focus, another one receives the releases of keys that are held.
    glfwSetWindowFocusCallback(window_, [](GLFWwindow* window, int is_focused) {
        if (!is_focused) static_cast<Window*>(glfwGetWindowUserPointer(window))->keys_down_.clear();
    });
    glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** names) {
        auto& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
        self.dropped_files_.insert(self.dropped_files_.end(), names, names + count);
    });
}

std::vector<const char*> Window::instance_extensions() const {
    uint32_t count = 0;
    const char** names = glfwGetRequiredInstanceExtensions(&count);
    return {names, names + count};
}

VkSurfaceKHR Window::make_surface(VkInstance instance) const {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    if (glfwCreateWindowSurface(instance, window_, nullptr, &surface) != VK_SUCCESS)
        throw UserError("the window cannot be drawn to (" + glfw_error() + "): use --headless");
    return surface;
}

uvec2 Window::framebuffer_size() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    if (glfwGetWindowAttrib(window_, GLFW_ICONIFIED)) return {0, 0};
    return {static_cast<uint32_t>(width), static_cast<uint32_t>(height)};
}

float Window::scale() const {
    // Where window coordinates are already scaled, they include the content scale.
    float scale = 1;
    int window_width = 0, pixel_width = 0, ignored = 0;
    glfwGetWindowContentScale(window_, &scale, nullptr);
    glfwGetWindowSize(window_, &window_width, &ignored);
    glfwGetFramebufferSize(window_, &pixel_width, &ignored);
    if (pixel_width > 0 && window_width > 0) scale *= static_cast<float>(window_width) / static_cast<float>(pixel_width);
    return std::isfinite(scale) && scale > 0.5f ? scale : 1.0f;
}

double Window::refresh_seconds() const {
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
    return mode && mode->refreshRate > 0 ? 1.0 / mode->refreshRate : 1.0 / 60;
}

bool Window::should_close() const { return glfwWindowShouldClose(window_); }

void Window::poll_events(double max_wait_seconds) {
    if (max_wait_seconds > 0)
        glfwWaitEventsTimeout(max_wait_seconds);
    else
        glfwPollEvents();
}

void Window::clear_events() {
    keys_pressed_.clear();
    dropped_files_.clear();
}

}  // namespace lab
