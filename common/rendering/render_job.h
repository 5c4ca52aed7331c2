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
    uint32_t samples = 0;  // wanted in every pixel
    FilmRecord record = {};
    bool low_discrepancy = false;          // of the chapter
    std::optional<FilmFile> resumed = {};  // the run that this one continues

    // Whether the first half of 2^k samples is independent of the second, so that they tell the error. Of
    // low-discrepancy points samples 2^k to 2^(k+1) - 1 share a scramble, counted from 0.
    bool has_independent_halves() const { return !low_discrepancy || record.first_sample == 0; }
    // The error of a film, told from an earlier state of it that has half the samples. Unknown for others,
    // and for films in which no sample has found light yet.
    std::optional<ErrorMetrics> error_from(const FilmImage& half, const FilmImage& whole) const;
};

// Samples a pixel at which a render that has fewer than `target` looks at its error next: at powers of two
// and at the target. A look at every dispatch would prefer images that look converged by chance.
uint32_t next_look(uint32_t samples, uint32_t target);

// Everything about the render that needs no device, so that mistakes show before one is asked for. Throws
// UserError for a scene that the chapter would render wrongly, and for options that contradict each other or
// what --resume continues.
RenderJob make_job(const Chapter& chapter, const Options& options, std::shared_ptr<const Scene> scene);

// Puts other options into a job of the same scene and estimator; what it continues is forgotten.
void set_options(RenderJob& job, const Chapter& chapter, const Options& options);

}  // namespace lab
