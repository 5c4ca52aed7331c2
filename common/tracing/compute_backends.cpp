// The backends that are compute shaders: `compute` traverses our hierarchy, `query` the driver's.
#include "tracing/gpu_bvh.h"
#include "tracing/hardware_bvh.h"
#include "tracing/vulkan_backends.h"

namespace lab {
namespace {

class ComputeTracer : public DeviceTracer {
  public:
    ComputeTracer(const Device& device, const std::vector<ShaderSource>& shaders, std::span<const Binding> bindings)
        : DeviceTracer(device, bindings), kernel_(device, shaders.front(), bindings, sizeof(DispatchParameters)) {}

  private:
    void record(const vk::raii::CommandBuffer& commands, const DispatchParameters& dispatch, uint32_t block_count,
                uint32_t film_offset) const override {
        kernel_.record(commands, &dispatch, block_count * dispatch.threads_per_pixel, film_offset);
    }

    ComputeKernel kernel_;
};

template <typename Tree>
class ComputeBackend : public SceneTree<Tree, ComputeTracer> {
  public:
    ComputeBackend(const Device& device, const GpuScene& scene, Tree tree, std::vector<std::string> defines)
        : SceneTree<Tree, ComputeTracer>(device, scene, std::move(tree)), defines_(std::move(defines)) {}

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        ShaderSource source = shader_source("engine/render.comp", this->scene_, estimator);
        source.defines.insert(source.defines.end(), defines_.begin(), defines_.end());
        return {source};
    }

  private:
    std::vector<std::string> defines_;
};

bool has_room(const Device& device, const Scene& scene) try {
    GpuBvh::require_room(device, scene);
    return true;
} catch (const std::runtime_error&) {
    return false;
}

std::unique_ptr<SceneBackend> build_compute(const Device& device, const GpuScene& scene) {
    GpuBvh::require_room(device, scene.scene());
    GpuBvh bvh(device, build_bvh(world_triangles(scene.scene())));
    auto defines = bvh.defines();
    return std::make_unique<ComputeBackend<GpuBvh>>(device, scene, std::move(bvh), std::move(defines));
}

std::unique_ptr<SceneBackend> build_query(const Device& device, const GpuScene& scene) {
    HardwareBvh bvh(device, scene);
    return std::make_unique<ComputeBackend<HardwareBvh>>(device, scene, std::move(bvh),
                                                         std::vector<std::string>{"BACKEND_QUERY"});
}

constexpr const char* query_extensions[] = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                            VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME, VK_KHR_RAY_QUERY_EXTENSION_NAME};
// Only `compute` traverses our own hierarchy, and only compute shaders can count lanes.
constexpr std::string_view compute_views[] = {"idle-lanes", "bvh-steps"};

}  // namespace

const BackendRow compute_row{.name = "compute", .special_views = compute_views, .suits = has_room, .build = build_compute};
const BackendRow query_row{
    .name = "query", .extensions = query_extensions, .special_views = std::span(compute_views).first(1), .build = build_query};

}  // namespace lab
