// A scene's arrays on the device. What the scene has not got is not allocated.
#pragma once
#include <vector>

#include "gpu/compute_kernel.h"
#include "scene/features.h"
#include "scene/scene.h"

namespace lab {

// What estimators choose light samples from: nothing, emissive triangles, or these and the light probe.
// Triangles and probe have a table each.
enum class LightSampling { off, on, with_probe };

class GpuScene {
  public:
    // Throws DeviceFailure before it allocates anything if the device cannot hold the scene.
    GpuScene(const Device& device, const Scene& scene, LightSampling light_sampling = LightSampling::on);

    const Scene& scene() const { return *scene_; }
    const Buffer& positions() const { return buffers_[0]; }
    const Buffer& triangles() const { return buffers_[1]; }

    // Bindings of the arrays, and the defines that make shaders/scene.glsl declare exactly these.
    const std::vector<Binding>& bindings() const { return bindings_; }
    const std::vector<std::string>& defines() const { return defines_; }

    // What it takes on the device, one for each array and image.
    const std::vector<MemoryNeed>& memory_needs() const { return memory_needs_; }

  private:
    void add_images(const Device& device, const SceneFeatures& features);

    const Scene* scene_;
    std::vector<Buffer> buffers_;
    std::vector<SampledImage> images_;
    std::vector<Binding> bindings_;
    std::vector<std::string> defines_;
    std::vector<MemoryNeed> memory_needs_;
};

}  // namespace lab
