#include "gpu/compute_kernel.h"

#include <algorithm>

namespace lab {

Binding buffer_binding(uint32_t index, vk::DescriptorType type, const Buffer& buffer, vk::DeviceSize size) {
    return {.index = index, .type = type, .buffers = {{buffer.handle(), 0, size}}, .host = buffer.mapped<std::byte>()};
}

Binding storage_binding(uint32_t index, const Buffer& buffer) {
    return buffer_binding(index, vk::DescriptorType::eStorageBuffer, buffer);
}

Binding uniform_binding(uint32_t index, const Buffer& buffer) {
    return buffer_binding(index, vk::DescriptorType::eUniformBuffer, buffer);
}

DescriptorSet::DescriptorSet(const Device& device, std::span<const Binding> bindings, vk::ShaderStageFlags stages) {
    std::vector<vk::DescriptorSetLayoutBinding> layout_bindings;
    std::vector<vk::DescriptorPoolSize> sizes;
    const auto count = [](const Binding& binding) {
        return static_cast<uint32_t>(std::max(
            {binding.buffers.size(), binding.images.size(), binding.texel_views.size(), binding.acceleration_structures.size()}));
    };
    for (const auto& binding : bindings) {
        layout_bindings.emplace_back(binding.index, binding.type, count(binding), stages);
        layout_text_ +=
            std::to_string(binding.index) + " " + vk::to_string(binding.type) + " " + std::to_string(count(binding)) + "\n";
        sizes.emplace_back(binding.type, count(binding));
    }
    layout_ = {device.handle(), vk::DescriptorSetLayoutCreateInfo({}, layout_bindings)};
    pool_ = {device.handle(), vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, sizes)};
    set_ = std::move(vk::raii::DescriptorSets(device.handle(), vk::DescriptorSetAllocateInfo(*pool_, *layout_)).front());
    std::vector<vk::WriteDescriptorSet> writes;
    std::vector<vk::WriteDescriptorSetAccelerationStructureKHR> structures(bindings.size());
    for (const auto& binding : bindings) {
        writes.emplace_back(*set_, binding.index, 0, count(binding), binding.type, binding.images.data(), binding.buffers.data(),
                            binding.texel_views.data());
        if (binding.acceleration_structures.empty()) continue;
        structures[writes.size() - 1].setAccelerationStructures(binding.acceleration_structures);
        writes.back().pNext = &structures[writes.size() - 1];
    }
    device.handle().updateDescriptorSets(writes, {});
}

ComputeKernel::ComputeKernel(const Device& device, const ShaderSource& source, std::span<const Binding> bindings,
                             uint32_t push_constant_size)
    : descriptors_(device, bindings, vk::ShaderStageFlagBits::eCompute), push_constant_size_(push_constant_size) {
    const auto words = compile_shader(source);
    const std::string key = descriptors_.layout_text() + std::to_string(push_constant_size) + "\n" + key_of(words);
    pipeline_ = device.share_pipeline(key, [&] {
        Pipeline made;
        const vk::raii::ShaderModule module(device.handle(), vk::ShaderModuleCreateInfo({}, words));
        const auto set_layout = descriptors_.layout();
        const vk::PushConstantRange range(vk::ShaderStageFlagBits::eCompute, 0, push_constant_size);
        made.layout = {device.handle(), vk::PipelineLayoutCreateInfo({}, 1, &set_layout, push_constant_size > 0, &range)};
        const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main");
        made.handle = {device.handle(), device.pipeline_cache(), vk::ComputePipelineCreateInfo({}, stage, *made.layout)};
        return made;
    });
}

std::string key_of(std::span<const uint32_t> words) { return {reinterpret_cast<const char*>(words.data()), words.size_bytes()}; }

void ComputeKernel::record(const vk::raii::CommandBuffer& commands, const void* push_constants, uint32_t group_count,
                           vk::ArrayProxy<const uint32_t> offsets) const {
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline_->handle);
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipeline_->layout, 0, descriptors_.handle(), offsets);
    if (push_constant_size_ > 0)
        (*commands).pushConstants(*pipeline_->layout, vk::ShaderStageFlagBits::eCompute, 0, push_constant_size_, push_constants,
                                  *commands.getDispatcher());
    commands.dispatch(group_count, 1, 1);
}

}  // namespace lab
