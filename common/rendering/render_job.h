// A render and everything that decides its expected image.
#pragma once
#include <memory>

#include "film/film_file.h"
#include "rendering/options.h"
#include "rendering/renderer.h"
#include "rendering/settings.h"

namespace lab {

struct RenderJob {
    Options options;
    Estimator estimator;
    std::shared_ptr<const Scene> scene;
    RenderParameters parameters{};
    uint32_t samples = 0;  // target per pixel
    FilmHeader header = {};
    std::optional<FilmFile> resumed = {};  // the run that this one continues
    FilterChoice filter = {};
    bool may_be_refused = false;  // for "auto": the caller is prepared for a backend that refuses the shader
};

// The sample count at which a render next computes its error: more by the factor `growth`, but by at least an eighth, at most a
// doubling, and never beyond the target. So checks are few and cheap. Checking after every dispatch would not only take time:
// where a few bright samples decide, it would favour pictures that happen to have few of them so far.
uint32_t next_sample_count(uint32_t samples, uint32_t target, double growth = 2);

// Loads a scene as the chapter renders it: without the ends of media, which are no surfaces, if it knows no media. Throws
// UserError.
std::shared_ptr<const Scene> load_scene_for(const Chapter& chapter, const SceneOptions& options);

// Prepares everything that needs no device, so that mistakes show early. Throws UserError for scenes that the chapter cannot
// render, and for options that contradict each other or the run that --resume continues.
RenderJob make_job(const Chapter& chapter, const Options& options, std::shared_ptr<const Scene> scene);

// Changes the options of a job with the same scene and estimator. It then no longer continues an earlier run.
void set_options(RenderJob& job, const Chapter& chapter, const Options& options);

}  // namespace lab
