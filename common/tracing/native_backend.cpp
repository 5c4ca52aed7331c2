// The `native` backend: the shaders of `compute` as C++ on the CPU. Embree traces the rays if the lab is built with it.
#ifdef LAB_EMBREE
#if LAB_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#endif

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

#ifdef LAB_EMBREE
class NativeTree {
  public:
    explicit NativeTree(const Scene& scene) {
        const auto triangles = world_triangles(scene);
        const auto start = Clock::now();
        device_.reset(rtcNewDevice(nullptr));
        rtcSetDeviceMemoryMonitorFunction(
            device_.get(),
            [](void* bytes, ssize_t change, bool) {
                *static_cast<std::atomic<size_t>*>(bytes) += static_cast<size_t>(change);
                return true;
            },
            &bytes_);
        scene_.reset(rtcNewScene(device_.get()));
        rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
        const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        const size_t count = triangles.size();
        places_.reserve(count);
        const auto buffer = [&](RTCBufferType type, size_t elements) {
            return rtcSetNewGeometryBuffer(
                geometry, type, 0, type == RTC_BUFFER_TYPE_VERTEX ? RTC_FORMAT_FLOAT3 : RTC_FORMAT_UINT3, sizeof(vec3), elements);
        };
        auto* const corners = static_cast<vec3*>(buffer(RTC_BUFFER_TYPE_VERTEX, 3 * count));
        auto* const indices = static_cast<uint32_t*>(buffer(RTC_BUFFER_TYPE_INDEX, count));
        if (count > 0 && (!corners || !indices)) throw std::bad_alloc();
        for (size_t i = 0; i < count; ++i) {
            const BvhTriangle& triangle = triangles[i];
            places_.push_back({triangle.instance, triangle.triangle});
            for (int corner = 0; corner < 3; ++corner) {
                corners[3 * i + corner] = {triangle.x[corner], triangle.y[corner], triangle.z[corner]};
                indices[3 * i + corner] = static_cast<uint32_t>(3 * i) + corner;
            }
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_.get(), geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_.get());
        if (rtcGetDeviceError(device_.get()) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
        build_seconds_ = seconds_since(start);
    }

    std::vector<std::string> defines() const { return {"BACKEND_EMBREE"}; }
    void bind(native::Bindings& bindings) const {
        bindings.scene = this;
        bindings.trace = trace;
    }
    size_t bytes() const { return bytes_ + places_.size() * sizeof(Place); }
    double build_seconds() const { return build_seconds_; }

  private:
    static bool trace(const void* tree, const float* origin, const float* direction, float t_max, native::RayHit* hit) {
        const auto& self = *static_cast<const NativeTree*>(tree);
        RTCRayHit query;
        query.ray = {.org_x = origin[0],
                     .org_y = origin[1],
                     .org_z = origin[2],
                     .tnear = 0,
                     .dir_x = direction[0],
                     .dir_y = direction[1],
                     .dir_z = direction[2],
                     .time = 0,
                     .tfar = t_max,
                     .mask = ~0u,
                     .id = 0,
                     .flags = 0};
#if LAB_EMBREE == 4
        constexpr auto no_arguments = nullptr;
        if (!hit) rtcOccluded1(self.scene_.get(), &query.ray, no_arguments);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        auto* const no_arguments = &context;
        if (!hit) rtcOccluded1(self.scene_.get(), no_arguments, &query.ray);
#endif
        if (!hit) return query.ray.tfar < 0;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if LAB_EMBREE == 4
        rtcIntersect1(self.scene_.get(), &query, no_arguments);
#else
        rtcIntersect1(self.scene_.get(), no_arguments, &query);
#endif
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
        const Place& place = self.places_[query.hit.primID];
        *hit = {place.instance, place.triangle, {query.hit.u, query.hit.v}, query.ray.tfar};
        return true;
    }

    struct Release {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };
    struct Place {  // of a triangle in the scene
        uint32_t instance, triangle;
    };
    std::vector<Place> places_;
    std::atomic<size_t> bytes_ = 0;
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device_;
    std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene_;
    double build_seconds_ = 0;
};
#else
class NativeTree {
  public:
    explicit NativeTree(const Scene& scene) : bvh_(build_bvh(world_triangles(scene))) {}

    std::vector<std::string> defines() const {
        return {"BVH_STACK_SIZE " + std::to_string(bvh_.stack_size()), "BVH_IN_STORAGE_BUFFERS"};
    }
    void bind(native::Bindings& bindings) const {
        bindings.ranges[BINDING_BVH_NODES] = range_of(std::span<const BvhNode>(bvh_.nodes));
        bindings.ranges[BINDING_BVH_TRIANGLES] = range_of(std::span<const BvhTriangle>(bvh_.triangles));
    }
    size_t bytes() const { return bvh_.nodes.size() * sizeof(BvhNode) + bvh_.triangles.size() * sizeof(BvhTriangle); }
    double build_seconds() const { return bvh_.build_seconds; }

  private:
    Bvh bvh_;
};
#endif

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
