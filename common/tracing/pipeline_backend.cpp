// The `pipeline` backend: ray generation, miss and closest-hit shaders of the ray tracing pipeline.
#include <algorithm>
#include <cstring>

#include "tracing/hardware_bvh.h"
#include "tracing/vulkan_backends.h"

namespace lab {
namespace {

constexpr auto all_stages =
    vk::ShaderStageFlagBits::eRaygenKHR | vk::ShaderStageFlagBits::eMissKHR | vk::ShaderStageFlagBits::eClosestHitKHR;

vk::DeviceSize align(vk::DeviceSize size, vk::DeviceSize alignment) { return (size + alignment - 1) / alignment * alignment; }

// Shaders in the order of their records: ray generation, miss, then one hit group per material class.
constexpr uint32_t first_miss_group = 1;
constexpr uint32_t first_hit_group = 2;

class PipelineTracer : public DeviceTracer {
  public:
    PipelineTracer(const Device& device, const std::vector<ShaderSource>& shaders, const std::vector<Binding>& bindings)
        : DeviceTracer(device, bindings), descriptors_(device, bindings, all_stages) {
        std::vector<std::vector<uint32_t>> compiled;
        std::string key = descriptors_.layout_text();
        for (const ShaderSource& source : shaders) {
            compiled.push_back(compile_shader(source));
            key += key_of(compiled.back());
        }
        pipeline_ = device.share_pipeline(key, [&] { return create_pipeline(device, compiled); });
        fill_shader_binding_table(device, static_cast<uint32_t>(shaders.size()));
    }

  private:
    void record(const vk::raii::CommandBuffer& commands, const DispatchParameters& dispatch, uint32_t block_count,
                uint32_t film_offset) const override {
        commands.bindPipeline(vk::PipelineBindPoint::eRayTracingKHR, *pipeline_->handle);
        commands.bindDescriptorSets(vk::PipelineBindPoint::eRayTracingKHR, *pipeline_->layout, 0, descriptors_.handle(),
                                    film_offset);
        (*commands).pushConstants(*pipeline_->layout, all_stages, 0, sizeof dispatch, &dispatch, *commands.getDispatcher());
        commands.traceRaysKHR(ray_generation_records_, miss_records_, hit_records_, {},
                              block_count * dispatch.threads_per_pixel * BLOCK_SIZE, 1, 1);
    }

    Pipeline create_pipeline(const Device& device, const std::vector<std::vector<uint32_t>>& shaders) const {
        std::vector<vk::raii::ShaderModule> modules;
        std::vector<vk::PipelineShaderStageCreateInfo> stages;
        std::vector<vk::RayTracingShaderGroupCreateInfoKHR> groups;
        for (const auto& words : shaders) {
            modules.emplace_back(device.handle(), vk::ShaderModuleCreateInfo({}, words));
            const auto index = static_cast<uint32_t>(stages.size());
            const bool is_hit = index >= first_hit_group;
            const auto stage = is_hit                      ? vk::ShaderStageFlagBits::eClosestHitKHR
                               : index >= first_miss_group ? vk::ShaderStageFlagBits::eMissKHR
                                                           : vk::ShaderStageFlagBits::eRaygenKHR;
            stages.emplace_back(vk::PipelineShaderStageCreateFlags(), stage, *modules.back(), "main");
            groups.emplace_back(
                is_hit ? vk::RayTracingShaderGroupTypeKHR::eTrianglesHitGroup : vk::RayTracingShaderGroupTypeKHR::eGeneral,
                is_hit ? VK_SHADER_UNUSED_KHR : index, is_hit ? index : VK_SHADER_UNUSED_KHR, VK_SHADER_UNUSED_KHR,
                VK_SHADER_UNUSED_KHR);
        }
        // Only the ray generation shader traces rays: the loop over a path needs no recursion.
        constexpr uint32_t max_recursion_depth = 1;
        Pipeline made;
        const auto set_layout = descriptors_.layout();
        const vk::PushConstantRange range(all_stages, 0, sizeof(DispatchParameters));
        made.layout = {device.handle(), vk::PipelineLayoutCreateInfo({}, set_layout, range)};
        const vk::RayTracingPipelineCreateInfoKHR info({}, stages, groups, max_recursion_depth, {}, {}, {}, *made.layout);
        made.handle = {device.handle(), nullptr, device.pipeline_cache(), info};
        return made;
    }

    // Fills the shader binding table with the driver's handles. Sections of records must be aligned to the larger of two
    // alignments; here every record is.
    void fill_shader_binding_table(const Device& device, uint32_t group_count) {
        const auto properties = device.properties<vk::PhysicalDeviceRayTracingPipelinePropertiesKHR>();
        const vk::DeviceSize handle_size = properties.shaderGroupHandleSize;
        const vk::DeviceSize alignment = std::max(properties.shaderGroupBaseAlignment, properties.shaderGroupHandleAlignment);
        const vk::DeviceSize stride = align(handle_size, alignment);
        const auto handles =
            pipeline_->handle.getRayTracingShaderGroupHandlesKHR<uint8_t>(0, group_count, group_count * handle_size);
        // Buffers start at arbitrary addresses, so the table is moved to the next aligned one.
        table_.emplace(device, group_count * stride + alignment,
                       vk::BufferUsageFlagBits::eShaderBindingTableKHR | vk::BufferUsageFlagBits::eShaderDeviceAddress);
        const vk::DeviceAddress start = align(table_->address(), alignment);
        std::vector<uint8_t> table(table_->size());
        for (uint32_t group = 0; group < group_count; ++group)
            std::memcpy(&table[start - table_->address() + group * stride], &handles[group * handle_size], handle_size);
        table_->write(table.data(), table.size());
        const auto section = [&](uint32_t first, uint32_t end) {
            return vk::StridedDeviceAddressRegionKHR(start + first * stride, stride, (end - first) * stride);
        };
        ray_generation_records_ = section(0, first_miss_group);
        miss_records_ = section(first_miss_group, first_hit_group);
        hit_records_ = section(first_hit_group, group_count);
    }

    DescriptorSet descriptors_;
    std::shared_ptr<const Pipeline> pipeline_;
    std::optional<Buffer> table_;
    vk::StridedDeviceAddressRegionKHR ray_generation_records_, miss_records_, hit_records_;
};

class PipelineBackend : public SceneTree<HardwareBvh, PipelineTracer> {
  public:
    using SceneTree::SceneTree;

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        std::vector<ShaderSource> sources;
        for (const char* name : {"engine/render.rgen", "engine/trace_ray/miss.rmiss"})
            sources.push_back(shader_source(name, scene_, estimator));
        for (const uint32_t material_class : material_classes(scene_.scene())) {
            sources.push_back(shader_source("engine/trace_ray/closest_hit.rchit", scene_, estimator));
            sources.back().defines.push_back("MATERIAL_CLASS " + std::to_string(material_class) + "u");
        }
        return sources;
    }
};

std::unique_ptr<SceneBackend> build_pipeline(const Device& device, const GpuScene& scene) {
    return std::make_unique<PipelineBackend>(device, scene, HardwareBvh(device, scene));
}

constexpr const char* pipeline_extensions[] = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                               VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                               VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME};

}  // namespace

const BackendRow pipeline_row{.name = "pipeline", .extensions = pipeline_extensions, .build = build_pipeline};

}  // namespace lab
