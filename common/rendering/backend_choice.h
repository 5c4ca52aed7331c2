// Chooses the backend that renders a scene fastest on a device.
#pragma once
#include "rendering/render_job.h"

namespace lab {

// Whether a view can be shown with this backend.
bool can_show(const View& view, Backend backend);

// The backend that the job's options name; for "auto" the one that a short measurement on this scene finds
// fastest. The choice is kept for the device, its driver and the decade of the number of triangles, so only
// the first run pays for it. Views trace camera rays only, so that their speed says nothing about renders:
// "auto" is `compute` there. Throws UserError for a view that does not work with the backend.
Backend choose_backend(const RenderJob& job, const Device& device, const GpuScene& scene);

}  // namespace lab
