// A scene's arrays on the device. Arrays that the scene does not need are not allocated.
#pragma once
#include <string>
#include <vector>

#include "gpu/compute_kernel.h"
#include "tracing/scene_arrays.h"

namespace lab {

class GpuScene {
  public:
    // The arguments are those of SceneArrays. If the device cannot hold the scene, throws DeviceFailure before allocating
    // anything.
    GpuScene(const Device& device, const Scene& scene, Strategy strategy = Strategy::both, const Capabilities& handles = {});

    const Scene& scene() const { return *scene_; }
    const Buffer& positions() const { return buffers_[0]; }
    const Buffer& triangles() const { return buffers_[1]; }

    // Bindings of the arrays, and the defines that make shaders/world/scene.glsl declare exactly these.
    const std::vector<Binding>& bindings() const { return bindings_; }
    const std::vector<std::string>& defines() const { return defines_; }

    // Its device memory, one entry per array and image.
    const std::vector<MemoryNeed>& memory_needs() const { return memory_needs_; }

  private:
    const Scene* scene_;
    std::vector<Buffer> buffers_;
    std::vector<SampledImage> images_;
    std::vector<Binding> bindings_;
    std::vector<std::string> defines_;
    std::vector<MemoryNeed> memory_needs_;
};

}  // namespace lab
