// The driver's acceleration structure for `pipeline` and `query`: a bottom level (BLAS) per mesh file and a top level (TLAS) of
// instances.
#pragma once
#include <optional>

#include "tracing/gpu_scene.h"

namespace lab {

// Material classes in the scene, in ascending order: the pipeline has one hit group for each.
std::vector<uint32_t> material_classes(const Scene& scene);

class HardwareBvh {
  public:
    // Builds and compacts it. The device must support acceleration structures. Throws DeviceFailure if memory runs out.
    HardwareBvh(const Device& device, const GpuScene& scene);

    // The top level, and the first triangle of each geometry of each instance.
    std::vector<Binding> bindings() const;

    size_t bytes() const { return bytes_; }                  // of device memory, after compaction
    double build_seconds() const { return build_seconds_; }  // on the device

  private:
    // An acceleration structure and its buffer.
    struct Level {
        Buffer buffer;
        vk::raii::AccelerationStructureKHR handle = nullptr;
        vk::DeviceAddress address = 0;
    };
    Level make_level(vk::AccelerationStructureTypeKHR type, vk::DeviceSize size) const;
    Level build_level(vk::AccelerationStructureTypeKHR type, const std::vector<vk::AccelerationStructureGeometryKHR>& geometries,
                      const std::vector<vk::AccelerationStructureBuildRangeInfoKHR>& ranges);
    Level compact(const Level& level);
    Level build_mesh(const GpuScene& scene, const Mesh& mesh);
    Level build_top(const Scene& scene);

    const Device* device_;
    size_t bytes_ = 0;
    double build_seconds_ = 0;
    std::vector<Level> meshes_;
    std::optional<Level> top_;
    std::optional<Buffer> first_triangles_;
};

}  // namespace lab
