// Renders an estimator progressively, in dispatches of bounded time.
#pragma once
#include <optional>

#include "rendering/film.h"
#include "tracing/tracer.h"

namespace lab {

// The key that a seed gives to the random start states.
uvec2 seed_key(uint32_t seed);

// roulette_start for renders without Russian roulette.
inline constexpr uint32_t no_roulette = UINT32_MAX;

// The parameters of a scene as its file asks, with seed 1, no splitting and no roulette; optionally from another camera.
RenderParameters default_parameters(const Scene& scene, uvec2 image_size);
RenderParameters default_parameters(const Scene& scene, const CameraPose& camera, uvec2 image_size);

// splat_unit for an estimator, or 0 if camera paths find all light: without lamps and glass, and in media. It is 2^-40 of the
// brightest emission: no picture is brighter than its lamps, so 2^24 samples of a pixel fit into 64 bits.
float splat_unit_of(const Scene& scene, Strategy strategy, const Capabilities& handles);

class Renderer {
  public:
    // Memory that a renderer needs.
    static std::vector<MemoryNeed> memory_needs(uvec2 image_size, float splat_unit = 0);

    // Device and acceleration structure must outlive the renderer. `further_bindings` belong to the estimator; `max_film_window`
    // is passed to Film.
    Renderer(const Device& device, const SceneBackend& scene_backend, const Estimator& estimator,
             const RenderParameters& parameters, std::span<const Binding> further_bindings = {},
             size_t max_film_window = SIZE_MAX);

    // Makes one dispatch of about `dispatch_seconds` towards `target_samples` per pixel; returns true while more are needed.
    // Short dispatches keep driver watchdogs quiet and the program responsive: one sample of a large image can take a minute on a
    // slow device. Throws StuckLoop for an estimator with_limited_loops() if one does not end.
    bool advance(uint32_t target_samples);

    Film& film() { return film_; }
    const Film& film() const { return film_; }
    const Tracer& tracer() const { return *tracer_; }
    uint64_t rays() const { return rays_; }                    // traced so far
    double device_seconds() const { return device_seconds_; }  // on the device so far
    // Samples per pixel so far, averaged over the image.
    double samples() const;

    // Restarts with other parameters, but the same splat_unit, for an image of at most as many pixels as the first one.
    void restart(const RenderParameters& parameters);
    // Continues from an image of the same size.
    void resume(const FilmImage& image);
    void set_dispatch_seconds(double seconds) { dispatch_seconds_ = seconds; }

  private:
    uint32_t block_count() const;
    // Those that render `blocks` blocks from next_block_ on, all of them in the window, from finished_samples_ to pass_samples_.
    std::vector<DispatchParameters> steps_of_pass(uint32_t blocks, const FilmWindow& window) const;

    const Device* device_;
    Estimator estimator_;
    Buffer parameters_;
    std::optional<Buffer> samples_;  // of shared pixels, until added to the film
    Buffer ray_counters_;
    Film film_;
    std::unique_ptr<Tracer> tracer_;

    bool is_compiled_ = false;  // by the driver
    double dispatch_seconds_ = 0.1;
    double blocks_per_dispatch_ = 64;  // times samples; adapts to the device's speed
    uint32_t finished_samples_ = 0;    // of every pixel
    uint32_t pass_samples_ = 0;        // of pixels in blocks before next_block_
    uint32_t next_block_ = 0;
    uint64_t rays_ = 0;
    double device_seconds_ = 0;
};

}  // namespace lab
