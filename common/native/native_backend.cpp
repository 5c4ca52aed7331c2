#include "native/native_backend.h"

#include "clock.h"
#include "files/project_folder.h"
#include "native/module.h"
#include "platform.h"
#include "shaders/engine/trace_ray/world_triangles.h"
#include "tracing/bvh.h"
#include "tracing/vulkan_backends.h"

namespace lab {
namespace {

native::Bindings::Range range_of(const auto& array) {  // const is cast away: shaders write only where GLSL lets them
    const auto bytes = std::as_bytes(std::span(array));
    return {const_cast<std::byte*>(bytes.data()), bytes.size()};
}

// Binds the host's view of buffers.
void bind_host(native::Bindings& bound, std::span<const Binding> bindings) {
    for (const Binding& binding : bindings) bound.ranges[binding.index] = {binding.host.data(), binding.host.size()};
}

// Compiles a shader. Reports errors in it as the other backends do: they compile `checked`.
native::Code load_shader(const ShaderSource& checked, const ShaderSource& source) {
    compile_shader(checked);
    return native::load(compile_shader(source, true));
}

// What get_surface_point() knows of each triangle, see shaders/engine/trace_ray/world_triangles.comp.
class WorldTriangles {
  public:
    WorldTriangles(const GpuScene& scene, std::span<const BvhTriangle> triangles) : triangles_(triangles.size()) {
        uint32_t first = 0;
        for (uint32_t instance = 0; instance < scene.scene().instances.size(); ++instance) {
            const Mesh& mesh = scene.scene().mesh_of(instance);
            firsts_.push_back(first - mesh.first_triangle);
            first += mesh.triangle_count;
        }
        ShaderSource source{.file = project_folder() / "shaders/engine/trace_ray/world_triangles.comp"};
        if (features_of(scene.scene()).transforms) source.defines.emplace_back("FEATURE_TRANSFORMS");
        native::Bindings bound{};
        bind_host(bound, scene.bindings());
        const RenderParameters parameters{};  // are declared, but not used
        bound.ranges[BINDING_RENDER_PARAMETERS] = range_of(std::span(&parameters, 1));
        bound.ranges[BINDING_BVH_TRIANGLES] = range_of(triangles);
        bind(bound);
        native::run_groups(load_shader(source, source).run, bound, static_cast<uint32_t>((triangles.size() + 63) / 64));
    }

    void bind(native::Bindings& bindings) const {
        bindings.ranges[BINDING_WORLD_TRIANGLES] = range_of(triangles_);
        bindings.ranges[BINDING_FIRST_WORLD_TRIANGLES] = range_of(firsts_);
    }
    size_t bytes() const { return triangles_.size() * sizeof(CacheLine) + firsts_.size() * sizeof(uint32_t); }

  private:
    struct alignas(64) CacheLine {  // so that a triangle never lies in two of them
        WorldTriangle triangle;
    };
    static_assert(sizeof(CacheLine) == sizeof(WorldTriangle));

    LargeArray<CacheLine> triangles_;
    std::vector<uint32_t> firsts_;
};

// Embree's tree where that is installed, or else our own.
class NativeTree {
  public:
    explicit NativeTree(std::span<const BvhTriangle> triangles) {
        using Triangle = native::RayTracer::Triangle;
        static_assert(sizeof(Triangle) == sizeof(BvhTriangle) && offsetof(Triangle, z) == offsetof(BvhTriangle, z));
        const auto make_ray_tracer = native::load_embree();
        const auto start = Clock::now();
        if (make_ray_tracer)
            rays_.reset(make_ray_tracer(reinterpret_cast<const Triangle*>(triangles.data()), triangles.size()));
        else
            bvh_ = build_bvh(triangles);
        build_seconds_ = seconds_since(start);
    }

    std::vector<std::string> defines() const {
        if (rays_) return {"BACKEND_EMBREE"};
        return {"BVH_STACK_SIZE " + std::to_string(bvh_.stack_size()), "BVH_IN_STORAGE_BUFFERS"};
    }
    void bind(native::Bindings& bindings) const {
        bindings.rays = rays_.get();
        bindings.ranges[BINDING_BVH_NODES] = range_of(bvh_.nodes);
        bindings.ranges[BINDING_BVH_TRIANGLES] = range_of(bvh_.triangles);
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
    NativeTracer(native::Code code, const native::Bindings& bindings) : code_(std::move(code)), bindings_(bindings) {}

    std::optional<double> trace(std::span<const DispatchParameters> steps, uint32_t block_count,
                                uint32_t film_offset) const override {
        native::Bindings bindings = bindings_;
        bindings.ranges[BINDING_FILM].data += film_offset;
        const auto start = Clock::now();
        for (DispatchParameters step : steps) {
            bindings.push_constants = reinterpret_cast<std::byte*>(&step);
            native::run_groups(code_.run, bindings, block_count);
        }
        if (is_interrupted()) return std::nullopt;
        return seconds_since(start);
    }
    // A lane whose pixel is finished waits for its neighbours.
    bool wants_samples_together() const override { return code_.invocations_at_once > 1; }
    std::string note() const override {
        const int count = code_.invocations_at_once;
        return "each core      traces " + std::to_string(count) + (count == 1 ? " path" : " paths") + " at a time" +
               (code_.why_one_by_one.empty() ? "" : ": " + code_.why_one_by_one);
    }

  private:
    native::Code code_;
    native::Bindings bindings_;
};

class NativeBackend : public SceneBackend {
  public:
    NativeBackend(const GpuScene& scene, std::span<const BvhTriangle> triangles)
        : scene_(scene), tree_(triangles), triangles_(scene, triangles) {
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
        return {shader_with(tree_.defines(), estimator)};
    }

    std::unique_ptr<Tracer> make_tracer(const Estimator& estimator, std::span<const Binding> bindings) const override {
        native::Bindings bound{};
        bind_host(bound, bindings);
        bind_host(bound, scene_.bindings());
        bound.ranges[BINDING_TEXTURES] = range_of(textures_);
        bound.ranges[BINDING_LIGHT_PROBE] = range_of(std::span<const native::Texture>(&probe_, 1));
        tree_.bind(bound);
        triangles_.bind(bound);
        const auto checked = shader_with({"BVH_STACK_SIZE 1", "BVH_IN_STORAGE_BUFFERS"}, estimator);
        return std::make_unique<NativeTracer>(load_shader(checked, shaders(estimator).front()), bound);
    }

    bool can_share_pixels() const override { return false; }  // a processor takes blocks alone
    size_t bytes() const override { return tree_.bytes() + triangles_.bytes(); }
    double build_seconds() const override { return tree_.build_seconds(); }

  private:
    ShaderSource shader_with(const std::vector<std::string>& defines, const Estimator& estimator) const {
        ShaderSource source = shader_source("engine/render.comp", scene_, estimator);
        source.defines.insert(source.defines.end(), defines.begin(), defines.end());
        const auto shaders = std::filesystem::weakly_canonical(project_folder() / "shaders");
        source.replacements[shaders / "world/surface_point.glsl"] = shaders / "engine/trace_ray/world_triangles.glsl";
        return source;
    }

    const GpuScene& scene_;
    NativeTree tree_;
    WorldTriangles triangles_;
    std::vector<native::Texture> textures_;
    std::vector<glm::vec4> probe_texels_;
    native::Texture probe_{};
};

std::unique_ptr<SceneBackend> build(const Device&, const GpuScene& scene) {
    return std::make_unique<NativeBackend>(scene, world_triangles(scene.scene()));
}

std::vector<std::string> find_missing(const DeviceDescription& device) {
    std::vector<std::string> missing = native::missing_tools();
    if (!device.shares_memory) missing.insert(missing.begin(), "memory that it shares with the CPU (--device llvmpipe has it)");
    return missing;
}

// It may be faster than the other backends on CPUs with a compiler, for scenes that fit into memory.
bool suits(const Device& device, const Scene& scene) {
    constexpr uint64_t bytes_per_triangle = 512;  // while its tree is built
    const DeviceDescription& description = device.description();
    return description.kind == "CPU" && instanced_triangle_count(scene) < description.memory / bytes_per_triangle;
}

}  // namespace

const BackendRow native_row{.name = "native",
                            .may_refuse_shaders = true,
                            .further_needs = find_missing,
                            .details = native::ray_tracer_name,
                            .suits = suits,
                            .build = build};

}  // namespace lab
