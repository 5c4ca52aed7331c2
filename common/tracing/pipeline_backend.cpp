// The `pipeline` backend: ray generation, miss and closest-hit shaders of the ray tracing pipeline.
#include <cstring>

#include "tracing/backends.h"
#include "tracing/hardware_bvh.h"

namespace lab {
namespace {

constexpr auto all_stages = vk::ShaderStageFlagBits::eRaygenKHR | vk::ShaderStageFlagBits::eMissKHR |
                            vk::ShaderStageFlagBits::eClosestHitKHR;

vk::DeviceSize align(vk::DeviceSize size, vk::DeviceSize alignment) {
    return (size + alignment - 1) / alignment * alignment;
}

// The shaders in the order of their records: ray generation, two miss shaders, a hit group for each material
// class.
constexpr uint32_t first_miss_group = 1;
constexpr uint32_t first_hit_group = 3;

vk::ShaderStageFlagBits stage_flag(ShaderStage stage) {
    switch (stage) {
        case ShaderStage::ray_generation:
            return vk::ShaderStageFlagBits::eRaygenKHR;
        case ShaderStage::miss:
            return vk::ShaderStageFlagBits::eMissKHR;
        case ShaderStage::closest_hit:
            return vk::ShaderStageFlagBits::eClosestHitKHR;
        case ShaderStage::compute:
            break;
    }
    return vk::ShaderStageFlagBits::eCompute;
}

class PipelineTracer : public Tracer {
  public:
    PipelineTracer(const Device& device, const std::vector<ShaderSource>& shaders,
                   const std::vector<Binding>& bindings)
        : descriptors_(device, bindings, all_stages) {
        const auto set_layout = descriptors_.layout();
        const vk::PushConstantRange range(all_stages, 0, sizeof(DispatchParameters));
        layout_ = {device.handle(), vk::PipelineLayoutCreateInfo({}, set_layout, range)};
        create_pipeline(device, shaders);
        fill_shader_binding_table(device, static_cast<uint32_t>(shaders.size()));
    }

    void record(const vk::raii::CommandBuffer& commands, const DispatchParameters& dispatch,
                uint32_t block_count, uint32_t film_offset) const override {
        commands.bindPipeline(vk::PipelineBindPoint::eRayTracingKHR, *pipeline_);
        commands.bindDescriptorSets(vk::PipelineBindPoint::eRayTracingKHR, *layout_, 0, descriptors_.handle(),
                                    film_offset);
        (*commands).pushConstants(*layout_, all_stages, 0, sizeof dispatch, &dispatch,
                                  *commands.getDispatcher());
        commands.traceRaysKHR(ray_generation_records_, miss_records_, hit_records_, {},
                              block_count * dispatch.threads_per_pixel * BLOCK_SIZE, 1, 1);
    }

  private:
    void create_pipeline(const Device& device, const std::vector<ShaderSource>& shaders) {
        std::vector<vk::raii::ShaderModule> modules;
        std::vector<vk::PipelineShaderStageCreateInfo> stages;
        std::vector<vk::RayTracingShaderGroupCreateInfoKHR> groups;
        for (const ShaderSource& source : shaders) {
            const auto words = compile_shader(source);
            modules.emplace_back(device.handle(), vk::ShaderModuleCreateInfo({}, words));
            const auto index = static_cast<uint32_t>(stages.size());
            stages.emplace_back(vk::PipelineShaderStageCreateFlags(), stage_flag(source.stage),
                                *modules.back(), "main");
            const bool is_hit = source.stage == ShaderStage::closest_hit;
            groups.emplace_back(is_hit ? vk::RayTracingShaderGroupTypeKHR::eTrianglesHitGroup
                                       : vk::RayTracingShaderGroupTypeKHR::eGeneral,
                                is_hit ? VK_SHADER_UNUSED_KHR : index, is_hit ? index : VK_SHADER_UNUSED_KHR,
                                VK_SHADER_UNUSED_KHR, VK_SHADER_UNUSED_KHR);
        }
        // Rays are traced from the ray generation shader alone: the loop over a path needs no recursion.
        constexpr uint32_t max_recursion_depth = 1;
        const vk::RayTracingPipelineCreateInfoKHR info({}, stages, groups, max_recursion_depth, {}, {}, {},
                                                       *layout_);
        pipeline_ = {device.handle(), nullptr, device.pipeline_cache(), info};
    }

    // The table of shader handles that the driver reads. A record is a handle padded to the device's
    // alignment, and every section starts at a multiple of a second, larger one: mixing the two up reads
    // handles of other shaders.
    void fill_shader_binding_table(const Device& device, uint32_t group_count) {
        const auto properties = device.physical()
                                    .getProperties2<vk::PhysicalDeviceProperties2,
                                                    vk::PhysicalDeviceRayTracingPipelinePropertiesKHR>()
                                    .get<vk::PhysicalDeviceRayTracingPipelinePropertiesKHR>();
        const vk::DeviceSize handle_size = properties.shaderGroupHandleSize;
        const vk::DeviceSize base_alignment = properties.shaderGroupBaseAlignment;
        const vk::DeviceSize stride = align(handle_size, properties.shaderGroupHandleAlignment);
        const auto handles =
            pipeline_.getRayTracingShaderGroupHandlesKHR<uint8_t>(0, group_count, group_count * handle_size);

        vk::DeviceSize size = 0;
        const auto add_section = [&](uint32_t count, vk::DeviceSize section_stride) {
            const vk::StridedDeviceAddressRegionKHR section(size, section_stride, count * section_stride);
            size = align(size + section.size, base_alignment);
            return section;
        };
        // Vulkan wants size and stride of the ray generation section to be equal.
        ray_generation_records_ = add_section(1, align(stride, base_alignment));
        miss_records_ = add_section(first_hit_group - first_miss_group, stride);
        hit_records_ = add_section(group_count - first_hit_group, stride);

        std::vector<uint8_t> table(size);
        for (uint32_t group = 0; group < group_count; ++group) {
            vk::DeviceSize offset = ray_generation_records_.deviceAddress;
            if (group >= first_hit_group)
                offset = hit_records_.deviceAddress + (group - first_hit_group) * stride;
            else if (group >= first_miss_group)
                offset = miss_records_.deviceAddress + (group - first_miss_group) * stride;
            std::memcpy(&table[offset], &handles[group * handle_size], handle_size);
        }
        // Buffers start at an address of their own, so the table is moved to the next aligned one.
        table_.emplace_back(
            device, size + base_alignment,
            vk::BufferUsageFlagBits::eShaderBindingTableKHR | vk::BufferUsageFlagBits::eShaderDeviceAddress);
        const vk::DeviceAddress start = align(table_.front().address(), base_alignment);
        table.insert(table.begin(), start - table_.front().address(), 0);
        table_.front().write(table.data(), table.size());
        for (auto* section : {&ray_generation_records_, &miss_records_, &hit_records_})
            section->deviceAddress += start;
    }

    DescriptorSet descriptors_;
    vk::raii::PipelineLayout layout_ = nullptr;
    vk::raii::Pipeline pipeline_ = nullptr;
    std::vector<Buffer> table_;  // exactly one
    vk::StridedDeviceAddressRegionKHR ray_generation_records_, miss_records_, hit_records_;
};

class PipelineBackend : public SceneTree<HardwareBvh, make_pipeline_tracer> {
  public:
    using SceneTree::SceneTree;

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        std::vector<ShaderSource> sources;
        const auto add = [&](const char* name, ShaderStage stage) {
            sources.push_back(shader_source(name, stage, scene(), estimator));
        };
        add("render.rgen", ShaderStage::ray_generation);
        add("trace_ray/miss.rmiss", ShaderStage::miss);
        add("trace_ray/shadow_miss.rmiss", ShaderStage::miss);
        for (const uint32_t material_class : material_classes(scene().scene())) {
            add("trace_ray/closest_hit.rchit", ShaderStage::closest_hit);
            sources.back().defines.push_back("MATERIAL_CLASS " + std::to_string(material_class) + "u");
        }
        return sources;
    }
};

}  // namespace

std::unique_ptr<Tracer> make_pipeline_tracer(const Device& device, const std::vector<ShaderSource>& shaders,
                                             const std::vector<Binding>& bindings) {
    return std::make_unique<PipelineTracer>(device, shaders, bindings);
}

std::unique_ptr<AccelerationStructure> build_pipeline_backend(const Device& device, const GpuScene& scene) {
    return std::make_unique<PipelineBackend>(device, scene, HardwareBvh(device, scene));
}

}  // namespace lab
