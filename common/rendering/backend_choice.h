// Chooses the backend that renders a scene fastest on a device.
#pragma once
#include <string>

#include "rendering/options.h"
#include "rendering/renderer.h"

namespace lab {

// Whether a view can be shown with this backend.
bool can_show(const View& view, Backend backend);

// The backend of that name; for "auto" the one that a short measurement on this scene finds fastest. The
// choice is kept for the device, its driver and the decade of the number of triangles, so only the first run
// pays for it.
Backend choose_backend(const std::string& name, const Device& device, const GpuScene& scene,
                       const Estimator& estimator, RenderParameters parameters);

// The same as the options say. Views trace camera rays only, so that their speed says nothing about renders,
// and one looks into our own hierarchy. Throws UserError if that one is asked of another backend.
Backend choose_backend(const Options& options, const Device& device, const GpuScene& scene,
                       const Estimator& estimator, const RenderParameters& parameters);

}  // namespace lab
