#include "rendering/renderer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <utility>

#include "clock.h"
#include "files/project_folder.h"
#include "parallel.h"
#include "platform.h"
#include "tracing/limited_loops.h"

namespace lab {
namespace {

// Workgroups that keep a device busy that runs 4000 at a time. In images with fewer blocks, several workgroups share a block.
// This is a define, because the mere possibility slows large images down (docs/backends.md).
constexpr uint32_t enough_groups = 8192;
// Samples per workgroup and pixel that wait to be added to the film. With more, threads would wait less for others at the end,
// but all must fit into 128 MiB, the largest binding of some devices.
constexpr uint32_t samples_per_group = 20;

constexpr std::chrono::seconds patience(10);

// Says that a dispatch takes very long. Its shader may never end.
void remind_of_endless_loops(const Estimator& estimator) {
    const auto& file = estimator.observed.empty() ? estimator.file : estimator.observed;
    std::fprintf(stderr, "note: no sample for %d s: the device is busy, or a loop of %s does not end; Ctrl-C stops the program\n",
                 static_cast<int>(patience.count()), file.string().c_str());
}

bool are_pixels_shared(uvec2 image_size) { return 2 * count_blocks(image_size) <= enough_groups; }

MemoryNeed memory_need_of_samples() {
    return {"samples in flight", enough_groups * samples_per_group * BLOCK_SIZE * sizeof(vec3),
            vk::BufferUsageFlagBits::eStorageBuffer};
}

}  // namespace

uvec2 seed_key(uint32_t seed) {
    // SplitMix64 spreads neighbouring seeds over all 64 bits (Steele, Lea and Flood, OOPSLA 2014).
    uint64_t z = (uint64_t{seed} + 1) * 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    z ^= z >> 31;
    return {static_cast<uint32_t>(z), static_cast<uint32_t>(z >> 32)};
}

RenderParameters default_parameters(const Scene& scene, uvec2 image_size) {
    return default_parameters(scene, scene.camera, image_size);
}

RenderParameters default_parameters(const Scene& scene, const CameraPose& camera, uvec2 image_size) {
    return {.camera = make_camera(camera, image_size.x, image_size.y),
            .image_size = image_size,
            .seed_key = seed_key(1),
            .first_sample = 0,
            .max_path_length = scene.defaults.max_path_length,
            .only_path_length = -1,
            .background = scene.background,
            .probe_rotation = scene.probe_rotation,
            .splitting_factor = 1,
            .roulette_start = no_roulette,
            .survival_cap = 0.95f,
            .survival_weight = 1,
            .splat_unit = 0};
}

float splat_unit_of(const Scene& scene, Strategy strategy, const Capabilities& handles) {
    if (!handles.light_paths || strategy == Strategy::bounces) return 0;
    const SceneFeatures features = features_of(scene);
    if (!features.dielectrics || features.media) return 0;
    float brightest = 0;
    for (const Material& material : scene.materials)
        brightest = std::max({brightest, material.emission.r, material.emission.g, material.emission.b});
    return features.area_lights ? 0x1p-40f * brightest : 0;
}

std::vector<MemoryNeed> Renderer::memory_needs(uvec2 image_size, float splat_unit) {
    std::vector<MemoryNeed> needs{Film::memory_need(image_size.x, image_size.y)};
    if (are_pixels_shared(image_size)) needs.push_back(memory_need_of_samples());
    if (splat_unit > 0)
        for (MemoryNeed& need : Film::memory_needs_of_splats(image_size.x, image_size.y)) needs.push_back(std::move(need));
    return needs;
}

Renderer::Renderer(const Device& device, const SceneBackend& scene_backend, const Estimator& estimator,
                   const RenderParameters& parameters, std::span<const Binding> further_bindings, size_t max_film_window)
    : device_(&device),
      estimator_(estimator),
      parameters_(device, std::span<const RenderParameters>(&parameters, 1), vk::BufferUsageFlagBits::eUniformBuffer),
      ray_counters_(device, ray_counters_size, vk::BufferUsageFlagBits::eStorageBuffer, Buffer::Location::host),
      film_(device, parameters.image_size.x, parameters.image_size.y, max_film_window, parameters.splat_unit) {
    Estimator configured = estimator;
    if (film_.splat_unit() > 0) configured.defines.emplace_back("SPLATS");
    std::vector<Binding> bindings = film_.bindings();
    bindings.push_back(uniform_binding(BINDING_RENDER_PARAMETERS, parameters_));
    bindings.push_back(storage_binding(BINDING_RAY_COUNTERS, ray_counters_));
    if (are_pixels_shared(parameters.image_size) && estimator.max_threads_per_pixel > 1 && scene_backend.can_share_pixels()) {
        samples_.emplace(device, memory_need_of_samples());
        configured.defines.emplace_back("SHARED_PIXELS");
        bindings.push_back(storage_binding(BINDING_SAMPLES, *samples_));
    }
    bindings.insert(bindings.end(), further_bindings.begin(), further_bindings.end());
    tracer_ = scene_backend.make_tracer(configured, bindings);
}

uint32_t Renderer::block_count() const { return count_blocks({film_.width(), film_.height()}); }

double Renderer::samples() const {
    return finished_samples_ + static_cast<double>(next_block_) * (pass_samples_ - finished_samples_) / block_count();
}

void Renderer::restart(const RenderParameters& parameters) {
    parameters_.write(&parameters, sizeof parameters);
    film_.resize(parameters.image_size.x, parameters.image_size.y);
    finished_samples_ = next_block_ = 0;
    rays_ = 0;
    device_seconds_ = 0;
}

void Renderer::resume(const FilmImage& image) {
    film_.write(image);
    finished_samples_ = image.min_samples();
    next_block_ = 0;
}

std::vector<DispatchParameters> Renderer::steps_of_pass(uint32_t blocks, const FilmWindow& window) const {
    if (!samples_) return {{next_block_, 1, 0, pass_samples_, window.first_pixel}};
    std::vector<DispatchParameters> steps;
    const uint32_t groups_per_block = std::min(enough_groups / blocks, estimator_.max_threads_per_pixel);
    for (uint32_t samples = finished_samples_; samples < pass_samples_;) {
        const uint32_t added = std::min(groups_per_block * samples_per_group, pass_samples_ - samples);
        samples += added;
        steps.push_back({next_block_, std::min(groups_per_block, added), added, samples, window.first_pixel});
    }
    return steps;
}

bool Renderer::advance(uint32_t target_samples) {
    if (finished_samples_ >= target_samples) return false;
    // A pass brings all blocks to pass_samples_, several samples at a time if all blocks fit into one dispatch.
    const uint32_t blocks = block_count();
    if (next_block_ == 0) {
        const double fewest = tracer_->wants_samples_together() ? samples_per_group : 1;
        const auto step = static_cast<uint32_t>(std::max(blocks_per_dispatch_ / blocks, fewest));
        pass_samples_ = finished_samples_ + std::min(step, target_samples - finished_samples_);
    }
    const uint32_t step = pass_samples_ - finished_samples_;
    const double fitting = std::max(blocks_per_dispatch_ / step, 1.0);
    const uint32_t group_limit = device_->limits().maxComputeWorkGroupCount[0];
    const FilmWindow window = film_.window_from(next_block_);
    // Some drivers compile a shader when it first runs. A dispatch without samples lets them, so that the next one is measured
    // alone.
    if (!std::exchange(is_compiled_, true))
        tracer_->trace(std::array{DispatchParameters{next_block_, 1, 0, 0, window.first_pixel}}, 1, window.offset());
    const uint32_t count = static_cast<uint32_t>(
        std::min({fitting, static_cast<double>(group_limit), static_cast<double>(window.end_block - next_block_)}));

    const std::span<uint32_t> counters = ray_counters_.mapped<uint32_t>();
    std::fill(counters.begin(), counters.end(), 0);
    const auto start = Clock::now();
    std::optional<double> device_seconds;
    double seconds = 0;
    {
        const Watch watch(patience, [&] {
            remind_of_endless_loops(estimator_);
            return false;
        });
        device_seconds = tracer_->trace(steps_of_pass(count, window), count, window.offset());
        seconds = seconds_since(start);
    }
    check_loops(counters, estimator_);
    for (const uint32_t counter : counters.first(RAY_COUNTER_COUNT)) rays_ += counter;
    if (!device_seconds) return true;  // finished samples are in the film
    device_seconds_ += *device_seconds;

    // Blocks differ in cost, so the rate follows the last dispatch, and grows by a bounded factor.
    const double work = static_cast<double>(count) * step;
    blocks_per_dispatch_ = std::clamp(work * dispatch_seconds_ / std::max(seconds, 1e-6), 1.0, 4 * work);
    next_block_ += count;
    if (next_block_ == blocks) {
        next_block_ = 0;
        finished_samples_ = pass_samples_;
        film_.keep();
    }
    return finished_samples_ < target_samples;
}

}  // namespace lab
