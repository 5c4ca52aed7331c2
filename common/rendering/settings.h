// From a scene and the command line to render parameters. Flags override the scene file.
#pragma once
#include "rendering/options.h"
#include "rendering/renderer.h"
#include "tracing/gpu_scene.h"

namespace lab {

// Camera and background: from the scene file, unless flags override them. Chapters without a lens have a pinhole.
CameraPose camera_of(const Chapter& chapter, const Scene& scene, const Options& options);
vec3 background_of(const Scene& scene, const Options& options);

// Whether --background asks for a sky: the shaders must know even if the scene itself has none.
bool asks_for_sky(const Options& options);
bool asks_for_lens(const Options& options);  // --aperture-diameter, likewise

// Even paths that nothing else limits end here: a sample must finish in bounded time.
inline constexpr uint32_t safety_limit = 10000;
// Whether they do: the chapter has Russian roulette, and neither the scene nor an option limits the length.
bool ends_at_safety_limit(const Chapter& chapter, const Scene& scene, const Options& options);

// Throws UserError for options that contradict each other.
RenderParameters make_parameters(const Chapter& chapter, const Scene& scene, const Options& options);

// The pose as command line options, with this character before each value. The numbers are exact.
std::string camera_flags(const CameraPose& pose, char separator);

// The options that decide what is estimated and how, in a fixed order: renders with equal settings can be merged.
std::string settings_text(const Chapter& chapter, const RenderParameters& parameters, const Scene& scene, const Options& options);

// The chapter's shader and its defines.
Estimator estimator_of(const Chapter& chapter);

// The index of the value that these options give one of the chapter's choices.
size_t value_of(const ChapterChoice& choice, const Options& options);

// The filter that runs over the picture under these options.
struct FilterChoice {
    std::string name = {};    // "nl_means"
    std::string define = {};  // of filter.glsl
    uint32_t passes = 0;      // 0 without a filter
};
FilterChoice filter_of(const Chapter& chapter, const Options& options);

// What the picture shows under these options instead of radiance; empty if it shows radiance.
std::string shown_instead(const Chapter& chapter, const Scene& scene, const Options& options);

// How the chapter's estimator finds light under these options.
Strategy strategy_of(const Chapter& chapter, const Options& options);

// The same along the estimator's camera rays, but it shows what this file of shaders/observation/ makes of them.
Estimator observed_by(const std::string& file, Estimator estimator);

// The chapter's estimator, or what --view replaces it with.
Estimator make_estimator(const Chapter& chapter, const Options& options);

// In one line, an upper bound for the light that a chapter without a path length limit loses beyond the safety limit. The
// radiance that arrives after m bounces is at most a^m times the brightest emission, where a is the largest albedo.
std::string safety_limit_text(const Scene& scene);

}  // namespace lab
