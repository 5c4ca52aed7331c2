// The reference image of a scene, rendered by ./lab reference.
#pragma once
#include <variant>

#include "rendering/renderer.h"
#include "statistics/error_metrics.h"

namespace lab {

// Finds the reference for a render with these parameters: camera, sky and path length must match. If there is none, returns the
// reason, a line to follow "no verdict: ".
std::variant<Reference, std::string> find_reference(const Scene& scene, const RenderParameters& parameters);

// In one line, how a reference's attributes contradict the image: another scene or path length. Empty if they do not.
std::string mismatch(const Reference& reference, const Scene& scene, const RenderParameters& parameters);

}  // namespace lab
