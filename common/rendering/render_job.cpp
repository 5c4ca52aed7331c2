#include "rendering/render_job.h"

#include <algorithm>
#include <cmath>

#include "error.h"
#include "files/file.h"
#include "scene/media.h"

namespace lab {
namespace {

// Loads the earlier run that this one continues. Throws UserError if it rendered something else.
FilmFile load_earlier_run(const RenderJob& job) {
    const Options& options = job.options;
    FilmFile earlier = read_film(options.run.resume);
    if (options.samples.first_sample != 0 && options.samples.first_sample != earlier.header.first_sample)
        throw UserError("--first-sample " + std::to_string(options.samples.first_sample) + " does not fit " +
                        options.run.resume.string() + ", which starts at sample " + std::to_string(earlier.header.first_sample) +
                        ": leave it out");
    const FilmFile wanted{{job.parameters.image_size.x, job.parameters.image_size.y, {}}, job.header};
    require_same_render(earlier, wanted, options.run.resume.string(), "this command");
    return earlier;
}

void check_sample_count(const RenderJob& job) {
    if (uint64_t{job.header.first_sample} + job.samples > uint64_t{1} << 32)
        throw UserError("--first-sample + --samples is above 2^32: there are no more random numbers than that");
}

void check_scene(const Chapter& chapter, const Scene& scene) {
    if (features_of(scene).dielectrics && !chapter.handles.dielectrics)
        throw UserError(scene.file.string() + ": has a dielectric (d < 1 or Tr > 0), which " + chapter.name +
                        " cannot render: use chapter 6, ./lab run 6");
}

}  // namespace

uint32_t next_sample_count(uint32_t samples, uint32_t target, double growth) {
    const double next = std::ceil(samples * std::clamp(growth, 1.125, 2.0));
    return static_cast<uint32_t>(std::clamp(next, samples + 1.0, static_cast<double>(target)));
}

std::shared_ptr<const Scene> load_scene_for(const Chapter& chapter, const SceneOptions& options) {
    auto scene = std::make_shared<Scene>(load_scene(options.file, options.specular));
    if (!chapter.handles.media) leave_out_open_boundaries(*scene);
    return scene;
}

RenderJob make_job(const Chapter& chapter, const Options& options, std::shared_ptr<const Scene> scene) {
    check_scene(chapter, *scene);
    RenderJob job;
    job.estimator = make_estimator(chapter, options);
    job.scene = std::move(scene);
    job.header.chapter = chapter.name;
    job.header.scene = job.scene->file.filename().string();
    job.header.scene_hash = hexadecimal(job.scene->hash);
    job.header.estimator_hash = hexadecimal(estimator_hash(job.estimator));
    set_options(job, chapter, options);
    if (!options.run.resume.empty()) {
        job.resumed = load_earlier_run(job);
        job.header.first_sample = job.resumed->header.first_sample;
        job.parameters.first_sample = job.header.first_sample;
        job.header.seconds = job.resumed->header.seconds;
        job.header.rays = job.resumed->header.rays;
        check_sample_count(job);
    }
    return job;
}

void set_options(RenderJob& job, const Chapter& chapter, const Options& options) {
    job.options = options;
    job.parameters = make_parameters(chapter, *job.scene, options);
    job.samples = options.appearance.sample_count.value_or(job.scene->defaults.samples);
    job.filter = filter_of(chapter, options);
    if (job.filter.passes > 0 && options.run.target_error)
        throw UserError(
            "--target-error does not go with --filter, whose bias more samples may not reduce: leave one of them out");
    job.header.settings = settings_text(chapter, job.parameters, *job.scene, options);
    job.header.shows = shown_instead(chapter, *job.scene, options);
    job.header.seed = options.samples.seed;
    job.header.first_sample = options.samples.first_sample;
    job.header.seconds = 0;
    job.header.rays = 0;
    job.resumed.reset();
    check_sample_count(job);
}

}  // namespace lab
