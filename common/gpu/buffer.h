// Device memory: buffers and images.
#pragma once
#include <span>

#include "gpu/device.h"

namespace lab {

// A buffer or image to be allocated.
struct MemoryNeed {
    std::string what;  // "positions"
    size_t bytes;
    vk::BufferUsageFlags usage = {};
    bool is_seen_in_parts = false;  // bound part by part, so only the buffer's own limit counts
    vk::Extent2D image_size = {};   // in pixels, of an image
};

// Largest buffer that shaders can bind with this usage, in bytes.
size_t largest_visible(const Device& device, vk::BufferUsageFlags usage);

// Checks allocations before they are made. Throws DeviceFailure, with the numbers, if one exceeds the device's limit, if there
// are too many, or if together they exceed its memory.
void require_memory(const Device& device, std::span<const MemoryNeed> needs);

class Buffer {
  public:
    enum class Location {
        device,  // fast for shaders
        host,    // visible to the CPU at any time
    };
    // `size` in bytes; at least 16 are allocated. Throws DeviceFailure if it does not fit.
    Buffer(const Device& device, size_t size, vk::BufferUsageFlags usage, Location location = Location::device);

    Buffer(const Device& device, const MemoryNeed& need, Location location = Location::device);

    // Holds a copy of `data`.
    template <typename T>
    Buffer(const Device& device, std::span<const T> data, vk::BufferUsageFlags usage, Location location = Location::device)
        : Buffer(device, data.size_bytes(), usage, location) {
        write(data.data(), data.size_bytes());
    }

    vk::Buffer handle() const { return *buffer_; }
    size_t size() const { return size_; }
    vk::DeviceAddress address() const;  // needs the usage eShaderDeviceAddress

    // Copy to or from the start of the buffer, which the device must not be using meanwhile.
    void write(const void* data, size_t size);
    void read(void* data, size_t size) const;
    void clear();                    // to zeros
    void copy(const Buffer& other);  // of the same size

    // The contents of a host-visible buffer; empty for others.
    template <typename T>
    std::span<T> mapped() const {
        return {static_cast<T*>(mapped_), mapped_ ? size_ / sizeof(T) : 0};
    }

  private:
    const Device* device_;
    size_t size_;
    vk::raii::Buffer buffer_ = nullptr;
    vk::raii::DeviceMemory memory_ = nullptr;
    void* mapped_ = nullptr;
};

// A 2D colour image in device memory.
class DeviceImage {
  public:
    vk::Image handle() const { return *image_; }

  protected:
    // Starts in layout eUndefined. Throws DeviceFailure if it does not fit.
    DeviceImage(const Device& device, uint32_t width, uint32_t height, vk::Format format, vk::ImageUsageFlags usage);

    vk::raii::Image image_ = nullptr;
    vk::raii::DeviceMemory memory_ = nullptr;
    vk::raii::ImageView view_ = nullptr;
};

// An image that shaders read with texelFetch, without a sampler.
class SampledImage : public DeviceImage {
  public:
    // `pixels` in `format`, row by row without padding.
    SampledImage(const Device& device, uint32_t width, uint32_t height, vk::Format format, std::span<const std::byte> pixels);

    vk::DescriptorImageInfo info() const { return {{}, *view_, vk::ImageLayout::eShaderReadOnlyOptimal}; }
};

// An 8-bit RGBA image that compute shaders write, in layout eGeneral. Starts black.
class StorageImage : public DeviceImage {
  public:
    StorageImage(const Device& device, uint32_t width, uint32_t height);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    vk::DescriptorImageInfo info() const { return {{}, *view_, vk::ImageLayout::eGeneral}; }
    std::vector<uint8_t> read() const;  // row by row, four bytes per pixel

  private:
    const Device* device_;
    uint32_t width_;
    uint32_t height_;
};

// The whole of a colour image: for views and barriers, and for copies and blits.
inline constexpr vk::ImageSubresourceRange whole_image{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1};
inline constexpr vk::ImageSubresourceLayers whole_layer{vk::ImageAspectFlagBits::eColor, 0, 0, 1};

// Changes an image's layout, with a full barrier.
void change_layout(const vk::raii::CommandBuffer& commands, vk::Image image, vk::ImageLayout from, vk::ImageLayout to);

}  // namespace lab
