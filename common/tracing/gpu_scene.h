// A scene's arrays on the device. What the scene has not got is not allocated.
#pragma once
#include <map>
#include <vector>

#include "gpu/compute_kernel.h"
#include "scene/features.h"
#include "scene/scene.h"

namespace lab {

// Whether estimators sample the emissive triangles, which takes a table of them.
enum class LightSampling { off, on };

class GpuScene {
  public:
    GpuScene(const Device& device, const Scene& scene, LightSampling light_sampling = LightSampling::on);

    const Scene& scene() const { return *scene_; }
    const Buffer& positions() const { return buffers_[0]; }
    const Buffer& triangles() const { return buffers_[1]; }

    // Bindings of the arrays, and the defines that make shaders/scene.glsl declare exactly these.
    const std::vector<Binding>& bindings() const { return bindings_; }
    const std::vector<std::string>& defines() const { return defines_; }

    // Bytes of the array or the images behind each binding.
    const std::map<uint32_t, size_t>& bytes() const { return bytes_; }

  private:
    template <typename T>
    void add_buffer(const Device& device, uint32_t binding, const std::vector<T>& data,
                    vk::BufferUsageFlags usage = vk::BufferUsageFlagBits::eStorageBuffer);
    void add_images(const Device& device, const SceneFeatures& features);

    const Scene* scene_;
    std::vector<Buffer> buffers_;
    std::vector<SampledImage> images_;
    std::vector<Binding> bindings_;
    std::vector<std::string> defines_;
    std::map<uint32_t, size_t> bytes_;
};

}  // namespace lab
