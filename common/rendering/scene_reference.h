// The reference image of a scene, made by ./lab reference.
#pragma once
#include <variant>

#include "rendering/renderer.h"
#include "statistics/error_metrics.h"

namespace lab {

// Finds the reference for a render with these parameters, or says why there is none in a line that follows "no verdict: ":
// camera, sky and path length must match.
std::variant<Reference, std::string> find_reference(const Scene& scene, const RenderParameters& parameters);

// How a reference's attributes contradict the image, in one line: another scene or path length. Empty if they do not.
std::string mismatch(const Reference& reference, const Scene& scene, const RenderParameters& parameters);

}  // namespace lab
