// Which backend renders a job.
#pragma once
#include "rendering/render_job.h"

namespace lab {

// Whether a backend supports a view.
bool can_show(const View& view, Backend backend);

// The backend that the job's options ask for. "auto" measures which one is fastest on this scene and caches the choice by device,
// driver and decade of the triangle count. Views trace camera rays only, which would mislead the measurement, so they use
// `compute`. Throws UserError for a view that the backend does not support, DeviceError if the device lacks something for it.
Backend choose_backend(const RenderJob& job, const Device& device, const GpuScene& scene);

}  // namespace lab
