// What a window shows: a picture of the device and the user interface on top of it.
#pragma once
#include <memory>
#include <optional>

#include "image/image.h"
#include "viewer/display_pass.h"
#include "viewer/window.h"

namespace lab {

// Pixels of the window's framebuffer.
struct Rectangle {
    glm::ivec2 corner{0};
    glm::ivec2 size{0};
};

class Screen {
  public:
    // The device has the window's surface. There is at most one screen at a time, since Dear ImGui has one
    // context. Window and device must outlive it.
    Screen(const Device& device, const Window& window);
    ~Screen();

    // Starts a frame of the user interface: Dear ImGui may be used until show().
    void begin_frame();

    // Ends the frame and shows it: the picture fills the rectangle. `pass` may be null. Nothing is shown
    // while the window is minimised. Returns the seconds that went into waiting for the display.
    double show(const DisplayPass* pass, DisplayTransform transform, float exposure, const Rectangle& where);

    uvec2 size() const { return {extent_.width, extent_.height}; }  // pixels
    // What the window shows from the next show() on is also kept for a screenshot.
    void capture_next() { captures_ = true; }
    const Texture& captured() const { return captured_; }

  private:
    void start_user_interface();
    void make_swapchain();
    void remake_swapchain();  // needs the lock of the queue
    void record(const vk::raii::CommandBuffer& commands, uint32_t image, const DisplayPass* pass,
                DisplayTransform transform, float exposure, const Rectangle& where);
    void keep_capture();

    const Device* device_;
    const Window* window_;
    vk::SurfaceFormatKHR format_;
    vk::Extent2D extent_;
    vk::raii::RenderPass render_pass_ = nullptr;
    vk::raii::DescriptorPool descriptor_pool_ = nullptr;
    vk::raii::CommandPool command_pool_ = nullptr;
    vk::raii::CommandBuffer commands_ = nullptr;
    vk::raii::Fence fence_ = nullptr;
    vk::raii::Semaphore acquired_ = nullptr;
    vk::raii::SwapchainKHR swapchain_ = nullptr;
    std::vector<vk::Image> images_;
    std::vector<vk::raii::ImageView> views_;
    std::vector<vk::raii::Framebuffer> framebuffers_;
    std::vector<vk::raii::Semaphore> drawn_;  // one an image: presenting may still wait for it
    bool captures_ = false;
    std::optional<Buffer> capture_buffer_;
    Texture captured_;
};

}  // namespace lab
