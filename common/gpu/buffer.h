// Memory of a device: buffers and images.
#pragma once
#include <span>

#include "gpu/device.h"

namespace lab {

// Something that is about to be allocated.
struct MemoryNeed {
    std::string what;  // "positions"
    size_t bytes;
    vk::BufferUsageFlags usage = {};
    bool is_seen_in_parts = false;  // shaders see as much of it at a time as they can
    vk::Extent2D image_size = {};   // in pixels, of an image
};

// Bytes that shaders see of one buffer of this usage.
size_t largest_visible(const Device& device, vk::BufferUsageFlags usage);

// Throws DeviceFailure, with the numbers, for a buffer or an image that is larger than the device allows, for
// more of them, and for more bytes together than its memory has: so that nothing is allocated in vain.
void require_memory(const Device& device, std::span<const MemoryNeed> needs);

class Buffer {
  public:
    enum class Location {
        device,  // fast for shaders
        host,    // visible to the CPU at any time
    };
    // `size` in bytes (0 makes a buffer of the smallest size). Throws DeviceFailure if it does not fit the
    // device.
    Buffer(const Device& device, size_t size, vk::BufferUsageFlags usage,
           Location location = Location::device);

    Buffer(const Device& device, const MemoryNeed& need, Location location = Location::device);

    // Holds a copy of `data`.
    template <typename T>
    Buffer(const Device& device, std::span<const T> data, vk::BufferUsageFlags usage,
           Location location = Location::device)
        : Buffer(device, data.size_bytes(), usage, location) {
        write(data.data(), data.size_bytes());
    }

    vk::Buffer handle() const { return *buffer_; }
    size_t size() const { return size_; }
    vk::DeviceAddress address() const;  // needs the usage eShaderDeviceAddress

    // Copies to or from the start of the buffer; the device must not be using it.
    void write(const void* data, size_t size);
    void read(void* data, size_t size) const;
    void clear();  // to zeros

    // Contents of a host buffer.
    template <typename T>
    std::span<T> mapped() {
        return {static_cast<T*>(mapped_), size_ / sizeof(T)};
    }

  private:
    const Device* device_;
    size_t size_;
    vk::raii::Buffer buffer_ = nullptr;
    vk::raii::DeviceMemory memory_ = nullptr;
    void* mapped_ = nullptr;
};

// Two-dimensional colour image of the device's own.
class DeviceImage {
  public:
    vk::Image handle() const { return *image_; }

  protected:
    // Its layout is eUndefined. Throws DeviceFailure if it does not fit the device.
    DeviceImage(const Device& device, uint32_t width, uint32_t height, vk::Format format,
                vk::ImageUsageFlags usage);

    vk::raii::Image image_ = nullptr;
    vk::raii::DeviceMemory memory_ = nullptr;
    vk::raii::ImageView view_ = nullptr;
};

// Image that shaders read texel by texel, without a sampler.
class SampledImage : public DeviceImage {
  public:
    // `pixels` row by row without gaps in `format`.
    SampledImage(const Device& device, uint32_t width, uint32_t height, vk::Format format,
                 std::span<const std::byte> pixels);

    vk::DescriptorImageInfo info() const { return {{}, *view_, vk::ImageLayout::eShaderReadOnlyOptimal}; }
};

// Image of 8-bit RGBA that compute shaders write, always in the layout eGeneral. Starts black.
class StorageImage : public DeviceImage {
  public:
    StorageImage(const Device& device, uint32_t width, uint32_t height);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    vk::DescriptorImageInfo info() const { return {{}, *view_, vk::ImageLayout::eGeneral}; }
    std::vector<uint8_t> read() const;  // row by row, four bytes a pixel

  private:
    const Device* device_;
    uint32_t width_;
    uint32_t height_;
};

// All of a colour image, and one of its kind in copies and blits.
inline constexpr vk::ImageSubresourceRange whole_image{vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1};
inline constexpr vk::ImageSubresourceLayers whole_layer{vk::ImageAspectFlagBits::eColor, 0, 0, 1};

// Moves an image to another layout between all that came before and all that follows.
void change_layout(const vk::raii::CommandBuffer& commands, vk::Image image, vk::ImageLayout from,
                   vk::ImageLayout to);

}  // namespace lab
