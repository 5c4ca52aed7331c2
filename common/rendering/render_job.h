// A render and everything that decides its expected image.
#pragma once
#include <memory>

#include "film/film_file.h"
#include "rendering/options.h"
#include "rendering/renderer.h"
#include "statistics/error_metrics.h"

namespace lab {

struct RenderJob {
    Options options;
    Estimator estimator;
    std::shared_ptr<const Scene> scene;
    RenderParameters parameters{};
    uint32_t samples = 0;  // wanted per pixel
    FilmRecord record = {};
    bool low_discrepancy = false;          // of the chapter
    std::optional<FilmFile> resumed = {};  // the run that this one continues

    // Whether the two halves of 2^k samples are independent, so that their difference gives the error. Low-discrepancy samples
    // 2^k to 2^(k+1) - 1, counted from 0, share a scramble.
    bool has_independent_halves() const { return !low_discrepancy || record.first_sample == 0; }
    // Estimates the error of a film from an earlier state with half the samples. Unknown for other counts, and while the film is
    // black.
    std::optional<ErrorMetrics> error_from(const FilmImage& half, const FilmImage& whole) const;
};

// The sample count at which a render looks at its error next: a power of two or the target. Looking at every dispatch would
// favour images that look converged by chance.
uint32_t next_look(uint32_t samples, uint32_t target);

// Prepares everything that needs no device, so that mistakes show first. Throws UserError for scenes that the chapter cannot
// render, and for options that contradict each other or what --resume continues.
RenderJob make_job(const Chapter& chapter, const Options& options, std::shared_ptr<const Scene> scene);

// Changes the options of a job with the same scene and estimator, which no longer continues an earlier run.
void set_options(RenderJob& job, const Chapter& chapter, const Options& options);

// Whether a backend supports a view.
bool can_show(const View& view, Backend backend);

// The backend of the job's options; "auto" measures which is fastest on this scene and caches the choice by device, driver and
// decade of the triangle count. Views trace only camera rays, which would mislead the measurement: they use `compute`. Throws
// UserError for a view that the backend does not support.
Backend choose_backend(const RenderJob& job, const Device& device, const GpuScene& scene);

}  // namespace lab
