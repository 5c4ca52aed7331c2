#include "tracing/tracer.h"

namespace lab {

std::unique_ptr<AccelerationStructure> build_compute_bvh(const Device& device, const GpuScene& scene);

std::string to_string(Backend) { return "compute"; }

std::unique_ptr<AccelerationStructure> build_acceleration_structure(Backend, const Device& device,
                                                                    const GpuScene& scene) {
    return build_compute_bvh(device, scene);
}

}  // namespace lab
