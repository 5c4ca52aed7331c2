#include <algorithm>
#include <cmath>
#include <optional>

#include "clock.h"
#include "error.h"
#include "files/cache.h"
#include "files/file.h"
#include "native/module.h"
#include "rendering/render_job.h"
#include "tracing/gpu_bvh.h"
#include "tracing/limited_loops.h"

namespace lab {
namespace {

// Samples per second of the device, for an image of at most 128 x 128 pixels.
double measure_speed(Backend backend, const Device& device, const GpuScene& scene, const Estimator& estimator,
                     const RenderParameters& parameters) {
    const auto structure = build_acceleration_structure(backend, device, scene);
    Renderer renderer(device, *structure, estimator, parameters);
    renderer.set_dispatch_seconds(0.02);
    renderer.advance(UINT32_MAX);  // the first dispatch also warms up the device
    const double first_samples = renderer.samples();
    const double first_seconds = renderer.device_seconds();
    constexpr double seconds = 0.1;
    const auto start = Clock::now();
    // At least one more dispatch, even if the device's clock is coarse.
    do {
        renderer.advance(UINT32_MAX);
    } while (seconds_since(start) < seconds);
    return (renderer.samples() - first_samples) / std::max(renderer.device_seconds() - first_seconds, 1e-9);
}

std::string cache_name(const RenderJob& job, const Device& device, const GpuScene& scene) {
    const uint64_t triangles = instanced_triangle_count(scene.scene());
    const auto decade = static_cast<int>(std::log10(static_cast<double>(std::max<uint64_t>(triangles, 1))));
    const auto& description = device.description();
    const std::string candidates = job.may_choose_native ? native::ray_tracer_name() : "";
    return "backend-" + std::to_string(hash_text(description.name + description.driver + candidates)) + "-" +
           std::to_string(decade);
}

std::optional<Backend> find_backend(const std::string& name) {
    for (const Backend backend : all_backends)
        if (to_string(backend) == name) return backend;
    return std::nullopt;
}

bool fits_compute(const Device& device, const Scene& scene) try {
    GpuBvh::require_room(device, scene);
    return true;
} catch (const std::runtime_error&) {
    return false;
}

Backend find_fastest(const RenderJob& job, const Device& device, const GpuScene& scene) {
    const auto is_usable = [&](Backend backend) {
        if (backend == Backend::native) return job.may_choose_native;
        return device.description().supports(backend) && (backend != Backend::compute || fits_compute(device, *job.scene));
    };
    const std::string entry = cache_name(job, device, scene);
    if (const auto cached = read_cache(entry))
        if (const auto backend = find_backend(*cached); backend && is_usable(*backend)) return *backend;

    RenderParameters parameters = job.parameters;
    parameters.image_size = glm::min(parameters.image_size, uvec2(128));
    parameters.max_path_length = job.scene->defaults.max_path_length;  // the choice also serves later renders
    Backend fastest = Backend::compute;
    double highest_speed = 0;
    for (const Backend backend : all_backends) try {
            if (!is_usable(backend)) continue;
            const double speed = measure_speed(backend, device, scene, job.estimator, parameters);
            if (speed > highest_speed) {
                highest_speed = speed;
                fastest = backend;
            }
        } catch (const StuckLoop&) {
            return backend;  // the window tells of it; once the shader is mended, the next build measures
        }
    write_cache(entry, to_string(fastest));
    return fastest;
}

}  // namespace

bool suits_native(const Device& device, const Scene& scene) {
    constexpr uint64_t bytes_per_triangle = 512;  // while its tree is built
    const DeviceDescription& description = device.description();
    return description.kind == "CPU" && description.supports(Backend::native) &&
           instanced_triangle_count(scene) < description.memory / bytes_per_triangle;
}

bool can_show(const View& view, Backend backend) {
    if (backend == Backend::compute) return true;
    // Only `compute` traverses our own hierarchy, and only compute shaders can count lanes.
    if (view.name == "bvh-steps") return false;
    return view.name != "idle-lanes" || backend == Backend::query;
}

Backend choose_backend(const RenderJob& job, const Device& device, const GpuScene& scene) {
    const View* view = job.options.image.view;
    const std::string& name = job.options.run.backend;
    if (name == "auto" && !view) return find_fastest(job, device, scene);
    const Backend backend = find_backend(name).value_or(Backend::compute);
    if (view && !can_show(*view, backend))
        throw UserError("--view " + view->name + " does not work with the backend " + to_string(backend) +
                        ": leave --backend out or use compute");
    return backend;
}

}  // namespace lab
