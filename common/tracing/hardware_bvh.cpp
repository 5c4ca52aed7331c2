#include "tracing/hardware_bvh.h"

#include <algorithm>
#include <set>

namespace lab {
namespace {

using GeometryType = vk::GeometryTypeKHR;
using LevelType = vk::AccelerationStructureTypeKHR;

constexpr auto addressable = vk::BufferUsageFlagBits::eShaderDeviceAddress;

// Only material classes in the scene have a record, in ascending order.
uint32_t hit_record_offset(const Scene& scene, const Mesh& mesh) {
    const auto classes = material_classes(scene);
    const auto ranges = material_class_ranges(mesh);
    if (ranges.empty()) return 0;
    return static_cast<uint32_t>(std::find(classes.begin(), classes.end(), ranges.front().material_class) - classes.begin());
}

// Describes an instance to the driver. With one geometry per material class in a mesh and one hit record per class, the driver
// finds the record of a hit at instance offset + geometry index · stride, with stride 1 (the blog's equation).
vk::AccelerationStructureInstanceKHR describe_instance(const Scene& scene, uint32_t index, vk::DeviceAddress mesh_address) {
    const Mesh& mesh = scene.mesh_of(index);
    vk::AccelerationStructureInstanceKHR instance;
    const mat4x3& matrix = scene.instances[index].object_to_world;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            instance.transform.matrix[static_cast<size_t>(row)][static_cast<size_t>(column)] = matrix[column][row];
    instance.instanceCustomIndex = index & 0xffffffu;
    instance.mask = 0xffu;
    instance.instanceShaderBindingTableRecordOffset = hit_record_offset(scene, mesh) & 0xffffffu;
    // Surfaces reflect on both sides, so nothing is culled.
    instance.flags = static_cast<VkGeometryInstanceFlagsKHR>(vk::GeometryInstanceFlagBitsKHR::eTriangleFacingCullDisable);
    instance.accelerationStructureReference = mesh_address;
    return instance;
}

}  // namespace

std::vector<uint32_t> material_classes(const Scene& scene) {
    std::set<uint32_t> classes;
    for (const Mesh& mesh : scene.meshes)
        for (const auto& range : material_class_ranges(mesh)) classes.insert(range.material_class);
    return {classes.begin(), classes.end()};
}

HardwareBvh::HardwareBvh(const Device& device, const GpuScene& scene) : device_(&device) {
    for (const Mesh& mesh : scene.scene().meshes) meshes_.push_back(build_mesh(scene, mesh));
    top_ = build_top(scene.scene());
    for (const auto& level : meshes_) bytes_ += level.buffer.size();
    bytes_ += top_->buffer.size();

    std::vector<uint32_t> first_triangles;
    for (const uint32_t mesh : scene.scene().instance_meshes) {
        for (const auto& range : material_class_ranges(scene.scene().meshes[mesh]))
            first_triangles.push_back(range.first_triangle);
        first_triangles.resize((first_triangles.size() + 1) / 2 * 2);  // at most two geometries per instance
    }
    first_triangles_.emplace(device, std::span<const uint32_t>(first_triangles), vk::BufferUsageFlagBits::eStorageBuffer);
}

std::vector<Binding> HardwareBvh::bindings() const {
    return {{.index = BINDING_ACCELERATION_STRUCTURE,
             .type = vk::DescriptorType::eAccelerationStructureKHR,
             .acceleration_structures = {*top_->handle}},
            storage_binding(BINDING_GEOMETRY_FIRST_TRIANGLES, *first_triangles_)};
}

HardwareBvh::Level HardwareBvh::make_level(LevelType type, vk::DeviceSize size) const {
    Level level{.buffer = Buffer(*device_, size, vk::BufferUsageFlagBits::eAccelerationStructureStorageKHR | addressable)};
    level.handle = {device_->handle(), vk::AccelerationStructureCreateInfoKHR({}, level.buffer.handle(), 0, size, type)};
    level.address = device_->handle().getAccelerationStructureAddressKHR({*level.handle});
    return level;
}

HardwareBvh::Level HardwareBvh::build_level(LevelType type, const std::vector<vk::AccelerationStructureGeometryKHR>& geometries,
                                            const std::vector<vk::AccelerationStructureBuildRangeInfoKHR>& ranges) {
    auto flags = vk::BuildAccelerationStructureFlagsKHR(vk::BuildAccelerationStructureFlagBitsKHR::ePreferFastTrace);
    if (type == LevelType::eBottomLevel) flags |= vk::BuildAccelerationStructureFlagBitsKHR::eAllowCompaction;
    vk::AccelerationStructureBuildGeometryInfoKHR info(type, flags);
    info.setGeometries(geometries);
    std::vector<uint32_t> counts;
    for (const auto& range : ranges) counts.push_back(range.primitiveCount);
    const auto sizes =
        device_->handle().getAccelerationStructureBuildSizesKHR(vk::AccelerationStructureBuildTypeKHR::eDevice, info, counts);
    Level level = make_level(type, sizes.accelerationStructureSize);

    const vk::DeviceSize alignment = device_->properties<vk::PhysicalDeviceAccelerationStructurePropertiesKHR>()
                                         .minAccelerationStructureScratchOffsetAlignment;
    const Buffer scratch(*device_, sizes.buildScratchSize + alignment, vk::BufferUsageFlagBits::eStorageBuffer | addressable);
    info.dstAccelerationStructure = *level.handle;
    info.scratchData.deviceAddress = (scratch.address() + alignment - 1) / alignment * alignment;
    build_seconds_ += device_->submit(
        [&](const vk::raii::CommandBuffer& commands) { commands.buildAccelerationStructuresKHR(info, ranges.data()); });
    return level;
}

HardwareBvh::Level HardwareBvh::compact(const Level& level) {
    const vk::raii::QueryPool query(device_->handle(),
                                    vk::QueryPoolCreateInfo({}, vk::QueryType::eAccelerationStructureCompactedSizeKHR, 1));
    build_seconds_ += device_->submit([&](const vk::raii::CommandBuffer& commands) {
        commands.resetQueryPool(*query, 0, 1);
        commands.writeAccelerationStructuresPropertiesKHR(*level.handle, vk::QueryType::eAccelerationStructureCompactedSizeKHR,
                                                          *query, 0);
    });
    const auto [result, size] = query.getResult<vk::DeviceSize>(0, 1, sizeof(vk::DeviceSize),
                                                                vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    Level compacted = make_level(LevelType::eBottomLevel, size);
    build_seconds_ += device_->submit([&](const vk::raii::CommandBuffer& commands) {
        commands.copyAccelerationStructureKHR({*level.handle, *compacted.handle, vk::CopyAccelerationStructureModeKHR::eCompact});
    });
    return compacted;
}

HardwareBvh::Level HardwareBvh::build_mesh(const GpuScene& scene, const Mesh& mesh) {
    vk::AccelerationStructureGeometryTrianglesDataKHR triangles;
    triangles.vertexFormat = vk::Format::eR32G32B32Sfloat;
    triangles.vertexData.deviceAddress = scene.positions().address();
    triangles.vertexStride = sizeof(vec3);
    triangles.maxVertex = static_cast<uint32_t>(scene.scene().positions.size()) - 1;
    triangles.indexType = vk::IndexType::eUint32;
    triangles.indexData.deviceAddress = scene.triangles().address();
    std::vector<vk::AccelerationStructureGeometryKHR> geometries;
    std::vector<vk::AccelerationStructureBuildRangeInfoKHR> ranges;
    for (const auto& range : material_class_ranges(mesh)) {
        geometries.emplace_back(GeometryType::eTriangles, triangles, vk::GeometryFlagBitsKHR::eOpaque);
        ranges.emplace_back(range.triangle_count, static_cast<uint32_t>(range.first_triangle * sizeof(uvec3)));
    }
    return compact(build_level(LevelType::eBottomLevel, geometries, ranges));
}

HardwareBvh::Level HardwareBvh::build_top(const Scene& scene) {
    std::vector<vk::AccelerationStructureInstanceKHR> instances;
    for (uint32_t i = 0; i < scene.instances.size(); ++i)
        instances.push_back(describe_instance(scene, i, meshes_[scene.instance_meshes[i]].address));
    const Buffer buffer(*device_, std::span<const vk::AccelerationStructureInstanceKHR>(instances),
                        vk::BufferUsageFlagBits::eAccelerationStructureBuildInputReadOnlyKHR | addressable);
    vk::AccelerationStructureGeometryInstancesDataKHR data;
    data.data.deviceAddress = buffer.address();
    return build_level(LevelType::eTopLevel, {{GeometryType::eInstances, data}}, {{static_cast<uint32_t>(instances.size())}});
}

}  // namespace lab
