// Chooses the backend that renders a scene fastest on a device.
#pragma once
#include "rendering/render_job.h"

namespace lab {

// Whether a backend supports a view.
bool can_show(const View& view, Backend backend);

// The backend of the job's options; "auto" measures which is fastest on this scene and caches the choice by
// device, driver and decade of the triangle count. Views trace only camera rays, which would mislead the
// measurement: they use `compute`. Throws UserError for a view that the backend does not support.
Backend choose_backend(const RenderJob& job, const Device& device, const GpuScene& scene);

}  // namespace lab
