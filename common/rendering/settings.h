// From a scene and the command line to what is rendered. Flags win over the scene file.
#pragma once
#include "rendering/options.h"
#include "rendering/renderer.h"
#include "tracing/gpu_scene.h"

namespace lab {

// Camera and background: what the scene file says, with the flags in its place.
CameraPose camera_of(const Scene& scene, const Options& options);
vec3 background_of(const Scene& scene, const Options& options);

// Whether --background asks for a sky, which the shaders must know where the scene itself has none.
bool asks_for_sky(const Options& options);

// Throws UserError for options that contradict each other.
RenderParameters make_parameters(const Chapter& chapter, const Scene& scene, const Options& options);

// The pose as options of the command line, with this character before each value. The numbers are exact.
std::string camera_flags(const CameraPose& pose, char separator);

// The options that decide what is estimated and how, in a fixed order: renders with equal settings can be joined.
std::string settings_text(const Chapter& chapter, const RenderParameters& parameters, const Scene& scene, const Options& options);

// The chapter's shader and what it is compiled with.
Estimator estimator_of(const Chapter& chapter);

// What one of the chapter's choices is with these options: the value's number.
size_t value_of(const ChapterChoice& choice, const Options& options);

// How the chapter's estimator finds light with these options.
Strategy strategy_of(const Chapter& chapter, const Options& options);

// The chapter's estimator, or what --view and --split-every-hit put in its place.
Estimator make_estimator(const Chapter& chapter, const Options& options);

// What a chapter without a limit of the path length leaves out beyond its safety limit, in one line. The radiance that arrives
// after m bounces is at most a^m times the brightest emission, a the largest albedo.
std::string safety_limit_text(const Scene& scene);

}  // namespace lab
