// A render and everything that decides its expected image.
#pragma once
#include "film/film_file.h"
#include "rendering/options.h"
#include "rendering/renderer.h"
#include "rendering/report.h"

namespace lab {

struct RenderJob {
    const Options* options = nullptr;
    RenderParameters parameters{};
    uint32_t samples = 0;  // wanted in every pixel
    FilmRecord record = {};
    std::optional<FilmFile> resumed = {};  // the run that this one continues
    AccelerationRecord acceleration = {};
};

// Refuses a scene that the chapter's estimator would render wrongly.
void check_scene(const Chapter& chapter, const Scene& scene);

// Everything about the render that needs no device, so that mistakes show before one is asked for. The
// options must outlive the job. Throws UserError if they contradict each other or what --resume continues.
RenderJob make_job(const Chapter& chapter, const Scene& scene, const Estimator& estimator,
                   const Options& options);

// Notes what the job runs on; "several" where it continues a run on something else.
void record_device(RenderJob& job, const std::string& device, const std::string& backend);

// Puts other options into a job of the same scene and estimator; what it continues is forgotten.
void set_options(RenderJob& job, const Chapter& chapter, const Scene& scene, const Options& options);

}  // namespace lab
