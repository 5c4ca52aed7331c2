#include "app/run_chapter.h"

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "app/headless.h"
#include "error.h"
#include "gpu/cache.h"
#include "image/file.h"
#include "rendering/backend_choice.h"
#include "rendering/settings.h"

namespace lab {
namespace {

void print_devices() {
    const auto devices = list_devices();
    for (size_t i = 0; i < devices.size(); ++i) {
        const auto& device = devices[i];
        std::printf("%zu  %s (%s, Vulkan %s, %s)\n", i, device.name.c_str(), device.kind.c_str(),
                    device.api_version.c_str(), device.driver.c_str());
        for (const Backend backend : all_backends) {
            std::string missing;
            for (const auto& name : device.missing.at(backend))
                missing += (missing.empty() ? "" : ", ") + name;
            std::printf("   %-9s %s\n", to_string(backend).c_str(),
                        missing.empty() ? "works" : ("lacks " + missing).c_str());
        }
    }
}

// Fails before anything is rendered if a result could not be kept later.
void check_outputs(const Options& options) {
    for (const auto& file : options.outputs) check_writable(file);
    if (!options.report.empty()) check_writable(options.report, {".json", ".csv"});
}

// Refuses a scene that the chapter's estimator would render wrongly.
void check_scene(const Chapter& chapter, const Scene& scene) {
    if (features_of(scene).dielectrics && !chapter.dielectrics)
        throw UserError(scene.file.string() + ": has a dielectric (d < 1), which " + chapter.name +
                        " cannot render: use chapter 6, ./lab run 6");
}

// Throws UserError if the validation layers complained about the run.
void check_validation(const Device& device, const Options& options) {
    if (!options.validation) return;
    for (const auto& message : device.driver_messages()) std::cerr << "driver: " << message << "\n";
    for (const auto& message : device.validation_messages()) std::cerr << "validation: " << message << "\n";
    if (!device.validation_messages().empty())
        throw UserError("the validation layers complained " +
                        std::to_string(device.validation_messages().size()) + " times");
    if (!options.quiet) std::cout << "validation     no complaints\n";
}

// The earlier run that this one continues. Throws UserError if it rendered something else.
FilmFile load_earlier_run(const RenderJob& job, const Options& options) {
    FilmFile earlier = read_film(options.resume);
    if (options.first_sample != 0 && options.first_sample != earlier.record.first_sample)
        throw UserError("--first-sample " + std::to_string(options.first_sample) + " does not fit " +
                        options.resume.string() + ", which starts at sample " +
                        std::to_string(earlier.record.first_sample) + ": leave it out");
    const FilmFile wanted{{job.parameters.image_size.x, job.parameters.image_size.y, {}}, job.record};
    require_same_render(earlier, wanted, options.resume.string(), "this command");
    return earlier;
}

// Everything about the render that needs no device, so that mistakes show before one is asked for.
RenderJob make_job(const Chapter& chapter, const Scene& scene, const Estimator& estimator,
                   const Options& options) {
    RenderJob job{.options = &options,
                  .parameters = make_parameters(chapter, scene, options),
                  .samples = options.samples.value_or(scene.defaults.samples),
                  .record = {},
                  .resumed = std::nullopt,
                  .acceleration = {}};
    job.record = {.chapter = chapter.name,
                  .scene = scene.file.filename().string(),
                  .scene_hash = hexadecimal(scene.hash),
                  .estimator_hash = hexadecimal(hash_text(read_file(estimator.file, 1 << 24))),
                  .settings = settings_text(chapter, job.parameters, scene, options),
                  .backend = "",
                  .device = "",
                  .seed = options.seed,
                  .first_sample = options.first_sample};
    if (!options.resume.empty()) {
        job.resumed = load_earlier_run(job, options);
        job.record.first_sample = job.resumed->record.first_sample;
        job.parameters.first_sample = job.record.first_sample;
        job.record.seconds = job.resumed->record.seconds;
        job.record.rays = job.resumed->record.rays;
    }
    if (uint64_t{job.record.first_sample} + job.samples > uint64_t{1} << 32)
        throw UserError(
            "--first-sample + --samples is above 2^32: there are no more random numbers than that");
    return job;
}

// Views trace camera rays only, so that their speed says nothing about renders, and one looks into our own
// hierarchy.
Backend choose_backend(const Options& options, const Device& device, const GpuScene& scene,
                       const Estimator& estimator, const RenderParameters& parameters) {
    if (!options.view) return choose_backend(options.backend, device, scene, estimator, parameters);
    if (options.view->name == "bvh-steps" && options.backend != "auto" && options.backend != "compute")
        throw UserError("--view bvh-steps looks into our own hierarchy: leave --backend out or use compute");
    return choose_backend(options.backend == "auto" ? "compute" : options.backend, device, scene, estimator,
                          parameters);
}

void run(const Chapter& chapter, const Options& options) {
    check_outputs(options);
    Scene scene = load_scene(options.scene, options.specular);
    check_scene(chapter, scene);
    override_scene(scene, options);
    for (const auto& warning : scene.warnings)
        if (!options.quiet) std::cerr << "note: " << warning << "\n";
    const Estimator estimator = make_estimator(chapter, options);
    RenderJob job = make_job(chapter, scene, estimator, options);

    const Device device({options.device, options.validation});
    const MemoryNeed film = Film::memory_need(job.parameters.image_size.x, job.parameters.image_size.y);
    require_memory(device, {&film, 1});  // before the scene takes time and memory
    const bool samples_lights = chapter.light_sampling && options.light_sampling && !options.view;
    const GpuScene gpu_scene(device, scene, samples_lights ? LightSampling::on : LightSampling::off);
    const Backend backend = choose_backend(options, device, gpu_scene, estimator, job.parameters);
    const auto acceleration_structure = build_acceleration_structure(backend, device, gpu_scene);
    job.acceleration = {acceleration_structure->bytes(), acceleration_structure->build_seconds()};
    job.record.device = device.description().name;
    job.record.backend = to_string(backend);
    if (!options.quiet)
        std::cout << chapter.name << ", " << job.record.scene << ", " << job.parameters.image_size.x << "x"
                  << job.parameters.image_size.y << ", " << job.samples << " samples, " << job.record.device
                  << ", backend " << job.record.backend << std::endl;
    if (!options.quiet && chapter.unlimited_path_length && !options.max_path_length &&
        !options.split_every_hit)
        std::cout << "path length    " << safety_limit_text(scene) << std::endl;
    if (job.resumed && job.resumed->record.device != job.record.device) job.record.device = "several";
    if (job.resumed && job.resumed->record.backend != job.record.backend) job.record.backend = "several";
    render_headless(device, *acceleration_structure, estimator, job);
    check_validation(device, options);
}

}  // namespace

int run_chapter(const Chapter& chapter, int argument_count, char** arguments) {
    try {
        const auto options = parse_options(chapter, argument_count, arguments);
        if (!options) return 0;
        if (options->list_devices)
            print_devices();
        else
            run(chapter, *options);
        return 0;
    } catch (const UserError& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 1;
    } catch (const DeviceError& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 2;
    } catch (const DeviceFailure& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 3;
    } catch (const vk::SystemError& error) {
        std::cerr << "error: the device failed: " << error.what() << "\n";
        return 3;
    } catch (const std::bad_alloc&) {
        std::cerr << "error: out of memory: use a smaller scene or image\n";
        return 3;
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 1;
    }
}

}  // namespace lab
