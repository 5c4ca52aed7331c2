#include "rendering/backend_choice.h"

#include <algorithm>
#include <cmath>

#include "clock.h"
#include "error.h"
#include "files/cache.h"
#include "files/file.h"
#include "tracing/limited_loops.h"
#include "tracing/vulkan_backends.h"

namespace lab {
namespace {

// Samples per second of the device, for an image of at most 128 x 128 pixels.
double measure_speed(Backend backend, const Device& device, const GpuScene& scene, const Estimator& estimator,
                     const RenderParameters& parameters) {
    const auto scene_backend = backend->build(device, scene);
    Renderer renderer(device, *scene_backend, estimator, parameters);
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

bool is_candidate(const RenderJob& job, const Device& device, Backend backend) {
    return (!backend->may_refuse_shaders || job.may_be_refused) && is_suitable(backend, device, *job.scene);
}

std::string entry_of(const RenderJob& job, const Device& device, const GpuScene& scene) {
    const uint64_t triangles = instanced_triangle_count(scene.scene());
    const auto decade = static_cast<int>(std::log10(static_cast<double>(std::max<uint64_t>(triangles, 1))));
    const auto& description = device.description();
    std::string candidates;
    for (const Backend backend : job.options.run.backends)
        if (backend->details && is_candidate(job, device, backend)) candidates += backend->details();
    return cache_name("backend", description.name + description.driver + candidates + "-" + std::to_string(decade));
}

// Null if the program has no backend of this name.
Backend find_backend(const RenderJob& job, const std::string& name) {
    const auto& backends = job.options.run.backends;
    const auto found = std::ranges::find(backends, name, &BackendRow::name);
    return found == backends.end() ? nullptr : *found;
}

void require_support(Backend backend, const RenderJob& job, const DeviceDescription& device) {
    const auto missing = missing_for(backend, device);
    if (missing.empty()) return;
    std::string working;
    for (const Backend other : job.options.run.backends)
        if (is_supported(other, device)) working += (working.empty() ? "" : ", ") + to_string(other);
    throw DeviceError("device '" + device.name + "' lacks " + missing.front() + " for the backend '" + to_string(backend) +
                      "'; these work on it: " + working);
}

Backend find_fastest(const RenderJob& job, const Device& device, const GpuScene& scene) {
    const std::string entry = entry_of(job, device, scene);
    if (const auto cached = read_cache(entry))
        if (const Backend backend = find_backend(job, *cached); backend && is_candidate(job, device, backend)) return backend;

    RenderParameters parameters = job.parameters;
    parameters.image_size = glm::min(parameters.image_size, uvec2(128));
    parameters.max_path_length = job.scene->defaults.max_path_length;  // the choice also serves later renders
    Backend fastest = compute_backend;
    double highest_speed = 0;
    for (const Backend backend : job.options.run.backends) try {
            if (!is_candidate(job, device, backend)) continue;
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

bool can_show(const View& view, Backend backend) {
    return !view.is_special || std::ranges::count(backend->special_views, view.name) > 0;
}

Backend choose_backend(const RenderJob& job, const Device& device, const GpuScene& scene) {
    const View* view = job.options.image.view;
    const std::string& name = job.options.run.backend;
    if (name == "auto" && !view) return find_fastest(job, device, scene);
    const Backend named = find_backend(job, name), backend = named ? named : compute_backend;
    if (view && !can_show(*view, backend))
        throw UserError("--view " + view->name + " does not work with the backend " + to_string(backend) +
                        ": leave --backend out or use compute");
    require_support(backend, job, device.description());
    return backend;
}

}  // namespace lab
