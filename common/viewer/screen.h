// Presents pictures with the user interface on top.
#pragma once
#include <memory>
#include <optional>
#include <span>

#include "film/film_image.h"
#include "gpu/compute_kernel.h"
#include "image/image.h"
#include "rendering/film.h"
#include "viewer/window.h"

namespace lab {

// Shows a film without reading it back: to_display() on the device.
class DisplayPass {
  public:
    // Device and film must outlive the pass. A film of any size is scaled to the picture.
    DisplayPass(const Device& device, const Film& film, std::shared_ptr<StorageImage> picture);

    // Updates the picture; pixels without samples stay as they are. `exposure` in stops.
    void record(const vk::raii::CommandBuffer& commands, DisplayTransform transform, float exposure) const;
    const StorageImage& picture() const { return *picture_; }
    const std::shared_ptr<StorageImage>& shared_picture() const { return picture_; }

  private:
    // One pass over the picture for each window of the film.
    void record_parts(const vk::raii::CommandBuffer& commands, DisplayParameters parameters) const;

    const Device* device_;
    const Film* film_;
    std::shared_ptr<StorageImage> picture_;
    Buffer largest_value_;
    ComputeKernel kernel_;
};

// In pixels of the window's framebuffer.
struct Rectangle {
    glm::ivec2 corner{0};
    glm::ivec2 size{0};
};

// A picture in the window, from one fraction of its width to another.
struct Layer {
    const DisplayPass* pass;
    DisplayTransform transform;
    float exposure;   // stops
    Rectangle where;  // of the whole picture
    float from = 0, to = 1;
};

class Screen {
  public:
    // The device must support the window's surface, and both must outlive the screen. Only one may exist at a time, because Dear
    // ImGui has a single context.
    Screen(const Device& device, const Window& window);
    ~Screen();

    // Starts a frame: use Dear ImGui until show().
    void begin_frame();

    // Finishes and shows the frame, unless the window is minimised. Returns the seconds spent waiting for the display.
    double show(std::span<const Layer> layers);

    uvec2 size() const { return {extent_.width, extent_.height}; }  // pixels
    // The next show() also keeps a screenshot.
    void capture_next() { captures_ = true; }
    const Texture& captured() const { return captured_; }

  private:
    void start_user_interface();
    // Needs the queue's lock once anything else uses the queue.
    void make_swapchain();
    // An image of the swapchain.
    struct Target {
        vk::Image image;
        vk::raii::ImageView view;
        vk::raii::Framebuffer framebuffer;
        vk::raii::Semaphore drawn;  // one per image, since presenting may still wait for it
    };
    void record(const vk::raii::CommandBuffer& commands, const Target& target, std::span<const Layer> layers);
    void draw(const vk::raii::CommandBuffer& commands, vk::Image image, const Layer& layer) const;
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
    std::vector<Target> targets_;  // empty while the window is minimised
    bool captures_ = false;
    std::optional<Buffer> capture_buffer_;
    Texture captured_;
};

}  // namespace lab
