// A compute shader with its resources.
#pragma once
#include <span>

#include "gpu/buffer.h"
#include "gpu/shader_compiler.h"

namespace lab {

// The resources of one binding of descriptor set 0.
struct Binding {
    uint32_t index;
    vk::DescriptorType type;
    std::vector<vk::DescriptorBufferInfo> buffers = {};
    std::vector<vk::DescriptorImageInfo> images = {};
    std::vector<vk::BufferView> texel_views = {};
    std::vector<vk::AccelerationStructureKHR> acceleration_structures = {};
    std::span<std::byte> host = {};  // contents of a host-visible buffer
};

// From the start of a buffer on, as many bytes as a shader may see.
Binding buffer_binding(uint32_t index, vk::DescriptorType type, const Buffer& buffer, vk::DeviceSize size = VK_WHOLE_SIZE);
Binding storage_binding(uint32_t index, const Buffer& buffer);
Binding uniform_binding(uint32_t index, const Buffer& buffer);

class DescriptorSet {
  public:
    DescriptorSet(const Device& device, std::span<const Binding> bindings, vk::ShaderStageFlags stages);

    vk::DescriptorSetLayout layout() const { return *layout_; }
    // Sets with equal descriptions of their layouts fit the same pipelines.
    const std::string& layout_text() const { return layout_text_; }
    vk::DescriptorSet handle() const { return *set_; }

  private:
    vk::raii::DescriptorSetLayout layout_ = nullptr;
    std::string layout_text_;
    vk::raii::DescriptorPool pool_ = nullptr;
    vk::raii::DescriptorSet set_ = nullptr;
};

class ComputeKernel {
  public:
    // `push_constant_size` in bytes. Throws UserError if the shader does not compile.
    ComputeKernel(const Device& device, const ShaderSource& source, std::span<const Binding> bindings,
                  uint32_t push_constant_size);

    // Dispatches `group_count` workgroups. `offsets` of dynamic bindings, in bytes.
    void record(const vk::raii::CommandBuffer& commands, const void* push_constants, uint32_t group_count,
                vk::ArrayProxy<const uint32_t> offsets = {}) const;

  private:
    DescriptorSet descriptors_;
    uint32_t push_constant_size_;
    std::shared_ptr<const Pipeline> pipeline_;
};

// SPIR-V as part of a key for Device::share_pipeline().
std::string key_of(std::span<const uint32_t> words);

}  // namespace lab
