// A scene's arrays on the device. Arrays that the scene does not need are not allocated.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "gpu/compute_kernel.h"
#include "scene/features.h"
#include "scene/scene.h"

namespace lab {

// How an estimator finds light: by light samples and bounces, weighted, or by only one of the two.
enum class Strategy { both, light, bounces };
inline constexpr std::array all_strategies{Strategy::both, Strategy::light, Strategy::bounces};
std::string to_string(Strategy strategy);

class GpuScene {
  public:
    // Builds tables to sample lights from, unless only bounces find them; a light probe gets one if the estimator samples it.
    // Materials have microfacets if the estimator handles them.
    // If the device cannot hold the scene, throws DeviceFailure before allocating anything.
    GpuScene(const Device& device, const Scene& scene, Strategy strategy = Strategy::both, bool samples_probe = false,
             bool handles_microfacets = false);

    const Scene& scene() const { return *scene_; }
    const Buffer& positions() const { return buffers_[0]; }
    const Buffer& triangles() const { return buffers_[1]; }

    // Bindings of the arrays, and the defines that make shaders/world/scene.glsl declare exactly these.
    const std::vector<Binding>& bindings() const { return bindings_; }
    const std::vector<std::string>& defines() const { return defines_; }

    // Its device memory, one entry per array and image.
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
