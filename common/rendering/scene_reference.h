// The reference image of a scene, rendered by ./lab reference.
#pragma once
#include <optional>
#include <variant>

#include "rendering/render_job.h"
#include "statistics/error_metrics.h"

namespace lab {

// Finds the reference for a render with these parameters: camera, sky and path length must match. If there is none, returns the
// reason, a line to follow "no verdict: ".
std::variant<Reference, std::string> find_reference(const Scene& scene, const RenderParameters& parameters);

// What to render to get a verdict.
struct VerdictSettings {
    uint32_t max_path_length;
    uvec2 image_size;
};

// The settings nearest to the parameters for which the scene has a reference. None if there is no reference, or if the parameters
// differ from it in more than path length and size.
std::optional<VerdictSettings> settings_for_verdict(const Scene& scene, const RenderParameters& parameters);

// In one line, how a reference's attributes contradict the image: another scene or path length, or something else than the image
// shows. Empty if they do not.
std::string mismatch(const Reference& reference, const RenderJob& job);

}  // namespace lab
