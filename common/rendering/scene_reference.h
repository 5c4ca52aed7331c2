// The image that a scene should converge to, if one has been made (./lab reference).
#pragma once
#include <variant>

#include "rendering/renderer.h"
#include "statistics/error_metrics.h"

namespace lab {

// The reference in assets/references that shows what is rendered with these parameters, or why there is none:
// in one line, to be shown after "no verdict: ". Moved cameras, another sky and other path lengths have other
// images.
std::variant<Reference, std::string> find_reference(const Scene& scene, const RenderParameters& parameters);

// What a reference says about itself that is not so of the image, in one line: it is of another scene or of
// other path lengths. Empty where it says nothing of the kind.
std::string mismatch(const Reference& reference, const Scene& scene, const RenderParameters& parameters);

}  // namespace lab
