#include "gpu/buffer.h"

#include <algorithm>
#include <cstring>

#include "error.h"
#include "parallel.h"

namespace lab {
namespace {

constexpr auto host_visible = vk::MemoryPropertyFlagBits::eHostVisible | vk::MemoryPropertyFlagBits::eHostCoherent;

struct Allocation {
    vk::raii::DeviceMemory memory;
    vk::MemoryPropertyFlags properties;
};

// One core alone does not copy as fast as memory allows.
void copy_in_parallel(void* target, const void* source, size_t size) {
    in_parallel(size, size_t{1} << 22, [&](size_t begin, size_t end) {
        std::memcpy(static_cast<std::byte*>(target) + begin, static_cast<const std::byte*>(source) + begin, end - begin);
    });
}

std::string mebibytes(size_t bytes) { return std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB"; }

[[noreturn]] void refuse_allocations(const Device& device) {
    throw DeviceFailure("too many arrays, textures and meshes for the device, which allows " +
                        std::to_string(device.limits().maxMemoryAllocationCount) + " of them: use a smaller scene");
}

// Allocates memory with all `required` and, if possible, the preferred properties. If preferred memory is used up, only devices
// that share the CPU's memory fall back to other types; a discrete GPU would slow to a crawl.
Allocation allocate(const Device& device, const vk::MemoryRequirements& requirements, vk::MemoryPropertyFlags required,
                    vk::MemoryPropertyFlags preferred, vk::MemoryAllocateFlags flags = {}) {
    const auto memory = device.physical().getMemoryProperties();
    bool is_used_up = false;
    for (const auto wanted : {required | preferred, required}) {
        if (is_used_up && !device.description().shares_memory) break;
        for (uint32_t type = 0; type < memory.memoryTypeCount; ++type) {
            const auto properties = memory.memoryTypes[type].propertyFlags;
            if (!(requirements.memoryTypeBits >> type & 1) || (properties & wanted) != wanted) continue;
            try {
                const vk::MemoryAllocateFlagsInfo flags_info(flags);
                const vk::MemoryAllocateInfo info(requirements.size, type, &flags_info);
                return {{device.handle(), info}, properties};
            } catch (const vk::TooManyObjectsError&) {
                refuse_allocations(device);
            } catch (const vk::OutOfDeviceMemoryError&) {
            } catch (const vk::OutOfHostMemoryError&) {
            }
            is_used_up = true;
        }
    }
    if (!is_used_up) throw DeviceError("the device has no suitable kind of memory");
    throw DeviceFailure("out of device memory: " + mebibytes(requirements.size) + " more are needed and the device has " +
                        mebibytes(device.description().memory) + " in all: use a smaller image or scene");
}

void require_size(const Device& device, const MemoryNeed& need) {
    const size_t limit = need.is_seen_in_parts ? device.description().largest_buffer : largest_visible(device, need.usage);
    if (need.bytes > limit)
        throw DeviceFailure("too large for the device: " + need.what + ", a buffer of " + mebibytes(need.bytes) +
                            " where it allows " + mebibytes(limit) + ": use a smaller image or scene");
    const uint32_t side = device.limits().maxImageDimension2D;
    if (std::max(need.image_size.width, need.image_size.height) > side)
        throw DeviceFailure("too large for the device: " + need.what + " of " + std::to_string(need.image_size.width) + " x " +
                            std::to_string(need.image_size.height) + " pixels, where it allows " + std::to_string(side) + " x " +
                            std::to_string(side) + " at most: make it smaller");
}

}  // namespace

size_t largest_visible(const Device& device, vk::BufferUsageFlags usage) {
    if (usage & vk::BufferUsageFlagBits::eUniformTexelBuffer) return size_t{16} * device.limits().maxTexelBufferElements;
    if (usage & vk::BufferUsageFlagBits::eStorageBuffer) return device.limits().maxStorageBufferRange;
    return SIZE_MAX;
}

void require_memory(const Device& device, std::span<const MemoryNeed> needs) {
    if (needs.size() > device.limits().maxMemoryAllocationCount) refuse_allocations(device);
    size_t sum = 0;
    for (const MemoryNeed& need : needs) {
        require_size(device, need);
        sum += need.bytes;
    }
    const size_t memory = device.description().memory;
    if (sum <= memory) return;
    const auto largest = std::ranges::max_element(needs, {}, &MemoryNeed::bytes);
    throw DeviceFailure("too large for the device: " + largest->what + " of " + mebibytes(largest->bytes) + ", " +
                        mebibytes(sum) + " in all, and it has " + mebibytes(memory) + ": use a smaller image or scene");
}

Buffer::Buffer(const Device& device, size_t size, vk::BufferUsageFlags usage, Location location)
    : Buffer(device, {"image or scene", size, usage}, location) {}

Buffer::Buffer(const Device& device, const MemoryNeed& need, Location location)
    : device_(&device), size_(std::max<size_t>(need.bytes, 16)) {
    require_memory(device, {&need, 1});
    const auto usage = need.usage | vk::BufferUsageFlagBits::eTransferSrc | vk::BufferUsageFlagBits::eTransferDst;
    buffer_ = {device.handle(), vk::BufferCreateInfo({}, size_, usage)};
    const auto required = location == Location::host ? host_visible : vk::MemoryPropertyFlags();
    const auto preferred =
        location == Location::host ? vk::MemoryPropertyFlagBits::eHostCached : vk::MemoryPropertyFlagBits::eDeviceLocal;
    const auto flags = usage & vk::BufferUsageFlagBits::eShaderDeviceAddress
                           ? vk::MemoryAllocateFlags(vk::MemoryAllocateFlagBits::eDeviceAddress)
                           : vk::MemoryAllocateFlags();
    auto [memory, properties] = allocate(device, buffer_.getMemoryRequirements(), required, preferred, flags);
    memory_ = std::move(memory);
    buffer_.bindMemory(*memory_, 0);
    if ((properties & host_visible) == host_visible) mapped_ = memory_.mapMemory(0, VK_WHOLE_SIZE);
}

vk::DeviceAddress Buffer::address() const { return device_->handle().getBufferAddress({*buffer_}); }

void Buffer::write(const void* data, size_t size) {
    if (mapped_) {
        copy_in_parallel(mapped_, data, size);
    } else if (size > 0) {
        Buffer staging(*device_, size, {}, Location::host);
        staging.write(data, size);
        device_->submit([&](const vk::raii::CommandBuffer& commands) {
            commands.copyBuffer(staging.handle(), handle(), vk::BufferCopy(0, 0, size));
        });
    }
}

void Buffer::read(void* data, size_t size) const {
    if (mapped_) {
        copy_in_parallel(data, mapped_, size);
    } else if (size > 0) {
        // In pieces, since drivers take long to make much memory visible to both sides.
        const Buffer staging(*device_, std::min(size, size_t{1} << 26), {}, Location::host);
        for (size_t begin = 0; begin < size; begin += staging.size()) {
            const size_t piece = std::min(staging.size(), size - begin);
            device_->submit([&](const vk::raii::CommandBuffer& commands) {
                commands.copyBuffer(handle(), staging.handle(), vk::BufferCopy(begin, 0, piece));
            });
            staging.read(static_cast<std::byte*>(data) + begin, piece);
        }
    }
}

void Buffer::copy(const Buffer& other) {
    if (mapped_ && other.mapped_)
        copy_in_parallel(mapped_, other.mapped_, size_);
    else
        device_->submit([&](const vk::raii::CommandBuffer& commands) {
            commands.copyBuffer(other.handle(), handle(), vk::BufferCopy(0, 0, size_));
        });
}

void Buffer::clear() {
    if (mapped_)
        std::memset(mapped_, 0, size_);
    else
        device_->submit([&](const vk::raii::CommandBuffer& commands) { commands.fillBuffer(handle(), 0, VK_WHOLE_SIZE, 0); });
}

DeviceImage::DeviceImage(const Device& device, uint32_t width, uint32_t height, vk::Format format, vk::ImageUsageFlags usage) {
    require_size(device, {.what = "an image", .bytes = 0, .image_size = {width, height}});
    image_ = {device.handle(),
              vk::ImageCreateInfo({}, vk::ImageType::e2D, format, {width, height, 1}, 1, 1, vk::SampleCountFlagBits::e1,
                                  vk::ImageTiling::eOptimal, usage | vk::ImageUsageFlagBits::eTransferDst)};
    memory_ = allocate(device, image_.getMemoryRequirements(), {}, vk::MemoryPropertyFlagBits::eDeviceLocal).memory;
    image_.bindMemory(*memory_, 0);
    view_ = {device.handle(), vk::ImageViewCreateInfo({}, *image_, vk::ImageViewType::e2D, format, {}, whole_image)};
}

SampledImage::SampledImage(const Device& device, uint32_t width, uint32_t height, vk::Format format,
                           std::span<const std::byte> pixels)
    : DeviceImage(device, width, height, format, vk::ImageUsageFlagBits::eSampled) {
    const Buffer staging(device, pixels, {}, Buffer::Location::host);
    device.submit([&](const vk::raii::CommandBuffer& commands) {
        constexpr auto target = vk::ImageLayout::eTransferDstOptimal;
        change_layout(commands, *image_, vk::ImageLayout::eUndefined, target);
        commands.copyBufferToImage(staging.handle(), *image_, target,
                                   vk::BufferImageCopy(0, 0, 0, whole_layer, {}, {width, height, 1}));
        change_layout(commands, *image_, target, vk::ImageLayout::eShaderReadOnlyOptimal);
    });
}

StorageImage::StorageImage(const Device& device, uint32_t width, uint32_t height)
    : DeviceImage(device, width, height, vk::Format::eR8G8B8A8Unorm,
                  vk::ImageUsageFlagBits::eStorage | vk::ImageUsageFlagBits::eTransferSrc),
      device_(&device),
      width_(width),
      height_(height) {
    device.submit([&](const vk::raii::CommandBuffer& commands) {
        constexpr auto target = vk::ImageLayout::eTransferDstOptimal;
        change_layout(commands, *image_, vk::ImageLayout::eUndefined, target);
        commands.clearColorImage(*image_, target, vk::ClearColorValue(std::array<float, 4>{0, 0, 0, 1}), whole_image);
        change_layout(commands, *image_, target, vk::ImageLayout::eGeneral);
    });
}

std::vector<uint8_t> StorageImage::read() const {
    std::vector<uint8_t> pixels(size_t{4} * width_ * height_);
    Buffer staging(*device_, pixels.size(), {}, Buffer::Location::host);
    device_->submit([&](const vk::raii::CommandBuffer& commands) {
        constexpr auto source = vk::ImageLayout::eTransferSrcOptimal;
        change_layout(commands, *image_, vk::ImageLayout::eGeneral, source);
        commands.copyImageToBuffer(*image_, source, staging.handle(),
                                   vk::BufferImageCopy(0, 0, 0, whole_layer, {}, {width_, height_, 1}));
        change_layout(commands, *image_, source, vk::ImageLayout::eGeneral);
    });
    staging.read(pixels.data(), pixels.size());
    return pixels;
}

void change_layout(const vk::raii::CommandBuffer& commands, vk::Image image, vk::ImageLayout from, vk::ImageLayout to) {
    const auto all = vk::PipelineStageFlagBits::eAllCommands;
    const auto any = vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite;
    commands.pipelineBarrier(all, all, {}, {}, {},
                             vk::ImageMemoryBarrier(vk::AccessFlagBits::eMemoryWrite, any, from, to, VK_QUEUE_FAMILY_IGNORED,
                                                    VK_QUEUE_FAMILY_IGNORED, image, whole_image));
}

}  // namespace lab
