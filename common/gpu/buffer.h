// Memory of a device: buffers, views of them as texels, and sampled images.
#pragma once
#include <span>

#include "gpu/device.h"

namespace lab {

// Something that is about to be allocated.
struct MemoryNeed {
    std::string what;  // "positions"
    size_t bytes;
    vk::BufferUsageFlags usage = {};
};

// Throws DeviceFailure, with the sizes, for a buffer that is larger than the device allows and for more bytes
// together than its memory has: so that nothing is allocated in vain.
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

    // Device buffer that holds a copy of `data`.
    template <typename T>
    Buffer(const Device& device, std::span<const T> data, vk::BufferUsageFlags usage)
        : Buffer(device, data.size_bytes(), usage) {
        write(data.data(), data.size_bytes());
    }

    vk::Buffer handle() const { return *buffer_; }
    size_t size() const { return size_; }
    vk::DeviceAddress address() const;  // needs the usage eShaderDeviceAddress

    // Copies to or from the start of the buffer; the device must not be using it.
    void write(const void* data, size_t size);
    void read(void* data, size_t size) const;

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

// Two-dimensional image that shaders read texel by texel.
class SampledImage {
  public:
    // `pixels` row by row without gaps in `format`.
    SampledImage(const Device& device, uint32_t width, uint32_t height, vk::Format format,
                 std::span<const std::byte> pixels);

    vk::DescriptorImageInfo info() const {
        return {*sampler_, *view_, vk::ImageLayout::eShaderReadOnlyOptimal};
    }
    size_t bytes() const { return bytes_; }  // of device memory

  private:
    size_t bytes_ = 0;
    vk::raii::Image image_ = nullptr;
    vk::raii::DeviceMemory memory_ = nullptr;
    vk::raii::ImageView view_ = nullptr;
    vk::raii::Sampler sampler_ = nullptr;
};

}  // namespace lab
