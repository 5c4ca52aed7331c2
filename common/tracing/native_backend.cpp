// The `native` backend: the shaders of `compute` as C++ on the CPU. Embree traces the rays where it is installed.
#include "clock.h"
#include "error.h"
#include "native/module.h"
#include "tracing/backends.h"
#include "tracing/bvh.h"

namespace lab {
namespace {

template <typename T>
native::Bindings::Range range_of(std::span<const T> data) {  // const is cast away: shaders write only where GLSL lets them
    return {reinterpret_cast<std::byte*>(const_cast<T*>(data.data())), data.size_bytes()};
}

// Embree's tree where that is installed, or else our own.
class NativeTree {
  public:
    explicit NativeTree(const Scene& scene) {
        const auto triangles = world_triangles(scene);
        const auto make_ray_tracer = native::load_embree();
        const auto start = Clock::now();
        if (make_ray_tracer) {
            std::vector<native::RayTracer::Triangle> copies;
            copies.reserve(triangles.size());
            for (const auto& [x, instance, y, triangle, z, padding] : triangles)
                copies.push_back({{{x[0], y[0], z[0]}, {x[1], y[1], z[1]}, {x[2], y[2], z[2]}}, instance, triangle});
            rays_.reset(make_ray_tracer(copies.data(), copies.size()));
        } else {
            bvh_ = build_bvh(triangles);
        }
        build_seconds_ = seconds_since(start);
    }

    std::vector<std::string> defines() const {
        if (rays_) return {"BACKEND_EMBREE"};
        return {"BVH_STACK_SIZE " + std::to_string(bvh_.stack_size()), "BVH_IN_STORAGE_BUFFERS"};
    }
    void bind(native::Bindings& bindings) const {
        bindings.rays = rays_.get();
        bindings.ranges[BINDING_BVH_NODES] = range_of(std::span<const BvhNode>(bvh_.nodes));
        bindings.ranges[BINDING_BVH_TRIANGLES] = range_of(std::span<const BvhTriangle>(bvh_.triangles));
    }
    size_t bytes() const {
        return rays_ ? rays_->bytes() : bvh_.nodes.size() * sizeof(BvhNode) + bvh_.triangles.size() * sizeof(BvhTriangle);
    }
    double build_seconds() const { return build_seconds_; }

  private:
    std::unique_ptr<native::RayTracer> rays_;
    Bvh bvh_;
    double build_seconds_ = 0;
};

class NativeTracer : public Tracer {
  public:
    NativeTracer(native::RunGroup run, const native::Bindings& bindings) : run_(run), bindings_(bindings) {}

    void record(const vk::raii::CommandBuffer&, const DispatchParameters& dispatch, uint32_t block_count,
                uint32_t film_offset) const override {
        native::Bindings bindings = bindings_;
        DispatchParameters constants = dispatch;
        bindings.push_constants = reinterpret_cast<std::byte*>(&constants);
        bindings.ranges[BINDING_FILM].data += film_offset;
        native::run_groups(run_, bindings, 0, block_count);
    }

  private:
    native::RunGroup run_;
    native::Bindings bindings_;
};

class NativeBackend : public AccelerationStructure {
  public:
    explicit NativeBackend(const GpuScene& scene) : scene_(scene), tree_(scene.scene()) {
        for (const Texture& texture : scene.scene().textures)
            textures_.push_back(
                {texture.pixels.data(), static_cast<int>(texture.width), static_cast<int>(texture.height), false});
        if (const auto& probe = scene.scene().light_probe) {
            for (size_t i = 0; i < probe->pixels.size(); i += 3)
                probe_texels_.emplace_back(probe->pixels[i], probe->pixels[i + 1], probe->pixels[i + 2], 1.0f);
            probe_ = {probe_texels_.data(), static_cast<int>(probe->width), static_cast<int>(probe->height), true};
        }
    }

    std::vector<ShaderSource> shaders(const Estimator& estimator) const override {
        ShaderSource source = shader_source("engine/render.comp", scene_, estimator);
        for (const auto& define : tree_.defines()) source.defines.push_back(define);
        return {source};
    }

    std::unique_ptr<Tracer> make_tracer(const Estimator& estimator, std::span<const Binding> bindings) const override {
        // Reports errors in a shader as the other backends do.
        ShaderSource source = shader_source("engine/render.comp", scene_, estimator);
        source.defines.insert(source.defines.end(), {"BVH_STACK_SIZE 1", "BVH_IN_STORAGE_BUFFERS"});
        compile_shader(source);
        native::Bindings bound{};
        std::vector<Binding> all(bindings.begin(), bindings.end());
        all.insert(all.end(), scene_.bindings().begin(), scene_.bindings().end());
        for (const Binding& binding : all) bound.ranges[binding.index] = {binding.host.data(), binding.host.size()};
        bound.ranges[BINDING_TEXTURES] = range_of(std::span<const native::Texture>(textures_));
        bound.ranges[BINDING_LIGHT_PROBE] = range_of(std::span<const native::Texture>(&probe_, 1));
        tree_.bind(bound);
        return std::make_unique<NativeTracer>(native::load(preprocess_shader(shaders(estimator).front())), bound);
    }

    bool is_on_host() const override { return true; }
    size_t bytes() const override { return tree_.bytes(); }
    double build_seconds() const override { return tree_.build_seconds(); }

  private:
    const GpuScene& scene_;
    NativeTree tree_;
    std::vector<native::Texture> textures_;
    std::vector<glm::vec4> probe_texels_;
    native::Texture probe_{};
};

}  // namespace

std::unique_ptr<AccelerationStructure> build_native_backend(const GpuScene& scene) {
    return std::make_unique<NativeBackend>(scene);
}

}  // namespace lab
