#include "app/run_chapter.h"

#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <iostream>
#include <optional>
#include <sstream>

#include "app/all_backends.h"
#include "error.h"
#include "files/file.h"
#include "gpu/device.h"
#include "native/module.h"
#include "platform.h"
#include "rendering/build.h"
#include "rendering/settings.h"
#include "scene/features.h"
#include "tracing/limited_loops.h"
#include "viewer/viewer.h"

namespace lab {
namespace {

void print_devices() {
    const auto devices = list_devices();
    for (size_t i = 0; i < devices.size(); ++i) {
        const auto& device = devices[i];
        std::printf("%zu  %s (%s, Vulkan %s, %s)\n", i, device.name.c_str(), device.kind.c_str(), device.api_version.c_str(),
                    device.driver.c_str());
        for (const Backend backend : all_backends) {
            std::string missing;
            for (const auto& name : missing_for(backend, device)) missing += (missing.empty() ? "" : ", ") + name;
            std::printf("   %-9s %s\n", backend->name, missing.empty() ? "works" : ("lacks " + missing).c_str());
            if (missing.empty() && backend->details) std::printf("   %s's rays: %s\n", backend->name, backend->details().c_str());
        }
        std::printf("   largest image %zu megapixels\n", Film::max_pixels(device) / 1000000);
    }
}

// Moves default outputs to the user's folder if the current one is not writable.
void choose_outputs(RunOptions& options) {
    const std::filesystem::path folder = user_folder();
    if (!options.has_default_outputs || folder.empty()) return;
    try {
        check_writable(options.outputs.front());
    } catch (const UserError& error) {
        for (auto& file : options.outputs) file = folder / "path_tracing_lab" / file.filename();
        std::cerr << "note: " << error.what() << ": pictures go to " << options.outputs.front().parent_path().string() << "\n";
    }
}

// Throws UserError before rendering if a result could not be written afterwards.
void check_outputs(const RunOptions& options) {
    for (const auto& file : options.outputs) check_writable(file);
    if (!options.report.empty()) check_writable(options.report, {".json", ".csv"});
}

// Throws UserError if a result would replace a file that the picture is made from. The one that --resume names may be replaced.
void check_inputs(const RunOptions& options, const Scene& scene) {
    auto inputs = scene.sources, outputs = options.outputs;
    inputs.push_back(options.reference);
    outputs.push_back(options.report);
    std::error_code none;  // where one of them does not exist
    for (const auto& input : inputs)
        for (const auto& output : outputs)
            if (std::filesystem::equivalent(input, output, none))
                throw UserError(output.string() + ": would replace a file that this picture is made from: choose another name");
}

// Throws UserError if the validation layers reported anything.
void check_validation(const Device& device, const RunOptions& options) {
    if (!options.validation) return;
    for (const auto& message : device.driver_messages()) std::cerr << "driver: " << message << "\n";
    for (const auto& message : device.validation_messages()) std::cerr << "validation: " << message << "\n";
    if (!device.validation_messages().empty())
        throw UserError("the validation layers complained " + std::to_string(device.validation_messages().size()) + " times");
    if (!options.quiet) std::cout << "validation     no complaints\n";
}

// Leaves room for picture and controls on a common screen.
uvec2 window_size(uvec2 image_size) { return glm::clamp(image_size + uvec2(360, 0), uvec2(900, 700), uvec2(1600, 1000)); }

// Opens a window or returns null. Without --window one opens only where it can and for people, since scripts read the output.
std::unique_ptr<Window> open_window(const Chapter& chapter, const Options& options, uvec2 image_size) {
    const bool is_forced = options.run.window == WindowChoice::always;
    if (options.run.window == WindowChoice::never) return nullptr;
    if (!is_forced && (window_systems().empty() || !is_terminal(stdout) || needs_no_window(options) || options.run.quiet))
        return nullptr;
    try {
        return std::make_unique<Window>(chapter.name, window_size(image_size));
    } catch (const UserError& error) {
        if (is_forced) throw;
        std::cerr << "note: " << error.what() << "\n";
        return nullptr;
    }
}

// Runs the chapter in the window; false if the device cannot present to it.
bool run_in_window(Window& window, const Chapter& chapter, const RenderJob& job) {
    const RunOptions& options = job.options.run;
    const Device device({.choice = options.device,
                         .validation = options.validation,
                         .instance_extensions = window.instance_extensions(),
                         .make_surface = [&](VkInstance instance) { return window.make_surface(instance); }});
    if (*device.surface()) {
        run_viewer(window, device, chapter, job);
        check_validation(device, options);
        return true;
    }
    const std::string why = "device '" + device.description().name + "' cannot show pictures in a window";
    if (options.window == WindowChoice::always) throw DeviceError(why + ": choose another with --device or use --headless");
    std::cerr << "note: " << why << ": rendering without one\n";
    return false;
}

void print_start(const Chapter& chapter, const Device& device, const Build& build) {
    const RenderJob& job = build.job;
    std::cout << chapter.name << ", " << job.header.scene << ", " << size_text(job.parameters.image_size) << ", " << job.samples
              << " samples, " << device.description().name << ", backend " << to_string(build.backend) << std::endl;
    if (!job.header.shows.empty()) std::cout << "shows          " << job.header.shows << std::endl;
    if (ends_at_safety_limit(chapter, *job.scene, job.options))
        std::cout << "path length    " << safety_limit_text(*job.scene) << std::endl;
    if (const std::string note = build.renderer->tracer().note(); !note.empty()) std::cout << note << std::endl;
}

// Builds a job without a window. If `auto` chooses a backend that refuses the shader, the others have to run it.
Build build_headless(const Device& device, const Chapter& chapter, RenderJob job, BuildStage first, const Build* before) {
    const auto may_refuse = [&](Backend backend) {
        return backend->may_refuse_shaders && is_suitable(backend, device, *job.scene);
    };
    job.may_be_refused = job.options.run.backend == "auto" && std::ranges::any_of(all_backends, may_refuse);
    if (!job.may_be_refused) return make_build(device, chapter, std::move(job), first, before);
    try {
        return make_build(device, chapter, job, first, before);
    } catch (const std::exception& error) {
        job.may_be_refused = false;
        Build build = make_build(device, chapter, std::move(job));  // throws the same for what no backend can run
        std::cerr << "note: " << error.what() << ": " << to_string(build.backend) << " renders instead\n";
        return build;
    }
}

// Renders a single pixel, for a debugger that stops in its shader.
void debug_pixel(Build& build, uvec2 pixel) {
    const uvec2 size = build.job.parameters.image_size;
    if (pixel.x >= size.x || pixel.y >= size.y)
        throw UserError("--debug-pixel " + std::to_string(pixel.x) + "," + std::to_string(pixel.y) +
                        " is outside of the image of " + size_text(size) + " pixels");
    while (build.renderer->advance(1)) {
    }
    const FilmImage film = build.renderer->film().read();
    const vec3 sum = film.pixels[size_t{pixel.y} * size.x + pixel.x].sum;
    std::printf("pixel          %u,%u sample %u: %g %g %g\n", pixel.x, pixel.y, build.job.header.first_sample, sum.r, sum.g,
                sum.b);
}

// Whether some output is a picture that --exposure makes brighter or darker.
bool writes_exposed_picture(const Options& options) {
    const auto is_exposed = [](const std::filesystem::path& file) {
        const std::string ending = lower_case_extension(file);
        return ending != ".exr" && ending != ".hdr";
    };
    return options.image.display() == DisplayTransform::exposure && std::ranges::any_of(options.run.outputs, is_exposed);
}

// One line for each option that was given but changes nothing.
std::vector<std::string> unused_options(const Chapter& chapter, const RenderJob& job, bool has_window) {
    std::vector<std::string> unused;
    const CameraOptions& camera = job.options.camera;
    const bool has_focus = camera.focus_distance && (!job.options.image.view || job.options.image.view->name != "focus");
    if (!chapter.handles.lens && has_focus) {
        unused.push_back("--focus-distance has no effect: " + chapter.name + " has a pinhole; use chapter 12, ./lab run 12");
    } else if (has_focus && camera_of(chapter, *job.scene, job.options).aperture_diameter == 0) {
        unused.push_back("--focus-distance has no effect on a pinhole: give --aperture-diameter, too");
    }
    if (job.options.scene.specular && !features_of(*job.scene).specular())
        unused.push_back("--specular has no effect: no material of " + job.scene->file.string() + " has a Phong lobe (Ks)");
    if (job.options.appearance.exposure != 0 && !has_window && !writes_exposed_picture(job.options))
        unused.push_back("--exposure has no effect: it brightens PNG and JPG pictures of radiance, and no output is one");
    const bool has_fog = chapter.handles.media && !job.scene->media.empty() && job.scene->media.front().extinction > 0 &&
                         job.scene->media.front().grid_size.x == 0;
    if (job.options.light.background && has_fog)
        unused.push_back("--background has no effect: no light gets through the endless fog of " + job.scene->file.string());
    return unused;
}

// One line for each choice that was given but shows nothing: instead of a view, or of a material that the scene lacks.
std::vector<std::string> futile_choices(const Chapter& chapter, const RenderJob& job) {
    const std::vector<std::string>& materials = job.scene->material_names;
    std::vector<std::string> futile;
    for (const ChapterChoice& choice : chapter.choices) {
        const size_t value = value_of(choice, job.options);
        if (value == 0) continue;
        if (job.options.image.view) {
            futile.push_back(choice.name + " has no effect on --view " + job.options.image.view->name);
        } else if (choice.chooses_material && value > materials.size()) {
            std::string names;
            for (const std::string& name : materials) names += (names.empty() ? "" : ", ") + in_quotes(name);
            futile.push_back(choice.name + ' ' + choice.values[value].first + " shows nothing: " + job.scene->file.string() +
                             " has " + std::to_string(materials.size()) +
                             (materials.size() == 1 ? " material: " : " materials: ") + names);
        }
    }
    return futile;
}

// Prints what is worth knowing about the scene of a job. Throws UserError if a report would describe another picture.
void print_warnings(const Chapter& chapter, const RenderJob& job, bool has_window) {
    std::vector<std::string> warnings = job.scene->warnings;
    const SceneFeatures features = features_of(*job.scene);
    const std::string scene = job.scene->file.string();
    struct {
        bool is_left_out;
        const char* what;
        std::string asked_by;
    } const extras[] = {{features.microfacets && !chapter.handles.microfacets, "microfacets (Pr)", scene},
                        {features.lens && !chapter.handles.lens, "lens (aperture diameter)", scene},
                        {asks_for_lens(job.options) && !features.lens && !chapter.handles.lens, "lens", "--aperture-diameter"},
                        {features.media && !chapter.handles.media, "media (fog, medium)", scene}};
    for (const auto& [is_left_out, what, asked_by] : extras) {
        if (!is_left_out) continue;
        const std::string use = ": use a chapter that can render it, see ./lab run";
        if (!job.options.run.report.empty())
            throw UserError("--report: " + chapter.name + " cannot render the " + what + " of " + asked_by + use);
        warnings.push_back(asked_by + ": " + chapter.name + " leaves out its " + what + use);
    }
    for (std::string& warning : unused_options(chapter, job, has_window)) warnings.push_back(std::move(warning));
    for (std::string& warning : futile_choices(chapter, job)) warnings.push_back(std::move(warning));
    const bool has_light = features.area_lights || features.light_probe || background_of(*job.scene, job.options) != vec3(0);
    if (!has_light && !job.options.image.view)
        warnings.push_back(job.scene->file.string() + ": nothing emits light: give a material Ke, or use --background 1,1,1");
    for (const auto& warning : warnings)
        if (!job.options.run.quiet) std::cerr << "note: " << warning << "\n";
}

// Runs command lines of a chapter. They share the device with its pipelines, and consecutive ones the scene if it is the same.
class Commands {
  public:
    explicit Commands(const Chapter& chapter) : chapter_(chapter) {}

    void run(const std::vector<std::string>& arguments) {
        auto options = parse_options(chapter_, all_backends, arguments);
        if (!options) return;
        if (options->run.batch) throw UserError("--batch goes alone: other options belong into the lines of the standard input");
        if (options->run.list_devices)
            print_devices();
        else
            render(std::move(*options));
    }

  private:
    void render(Options options) {
        native::set_mode(options.run.sanitize      ? native::Mode::checked
                         : options.run.debug_pixel ? native::Mode::debug
                                                   : native::Mode::fast);
        choose_outputs(options.run);
        check_outputs(options.run);
        const auto scene =
            build_ && build_->job.options.scene == options.scene ? build_->job.scene : load_scene_for(chapter_, options.scene);
        check_inputs(options.run, *scene);
        RenderJob job = make_job(chapter_, options, scene);
        // A time limit is checked between dispatches, so that each of them has to end.
        if (options.run.time_limit) job.estimator = with_limited_loops(std::move(job.estimator));
        auto window = open_window(chapter_, options, job.parameters.image_size);
        print_warnings(chapter_, job, window != nullptr);
        if (window && run_in_window(*window, chapter_, job)) return;
        window.reset();

        rebuild(std::move(job));
        if (options.estimator.max_threads_per_pixel && !build_->scene_backend->can_share_pixels() && !options.run.quiet)
            std::cerr << "note: --max-threads-per-pixel has no effect: " << to_string(build_->backend)
                      << " computes a pixel in one thread\n";
        if (!options.run.quiet) print_start(chapter_, *device_, *build_);
        if (options.run.debug_pixel)
            debug_pixel(*build_, *options.run.debug_pixel);
        else
            render_headless(*build_);
        check_validation(*device_, options.run);
    }

    // Builds a job, as far as it differs from the one before. Shaders are read again, since they may have been edited.
    void rebuild(RenderJob job) {
        const RunOptions& now = job.options.run;
        if (!build_ || build_->job.options.run.device != now.device || build_->job.options.run.validation != now.validation) {
            build_.reset();
            device_.emplace(DeviceOptions{.choice = now.device, .validation = now.validation});
        }
        BuildStage first = BuildStage::scene;
        // Views, too, decide which backends are suitable.
        if (build_ && build_->job.options.run.backend == now.backend && build_->job.options.image.view == job.options.image.view)
            first = std::min(first_difference(build_->job.options, job.options), BuildStage::renderer);
        if (first == BuildStage::scene) build_.reset();  // there may not be room for both
        build_ = build_headless(*device_, chapter_, std::move(job), first, build_ ? &*build_ : nullptr);
    }

    const Chapter& chapter_;
    std::optional<Device> device_;
    std::optional<Build> build_;  // of the last command line
};

// Prints an error in one line and returns the exit code.
int report(const std::exception& error, const std::string& place = "") {
    const Failure failure = failure_of(error);
    std::cerr << "error: " << place << failure.message << "\n";
    return failure.exit_code;
}

// Runs the command lines in the standard input up to the first error, and tells of each when it is done. Arguments with spaces
// are in double quotes, in which \" stands for a quote and \\ for a backslash.
int run_batch(Commands& commands) {
    std::vector<char> line(1 << 16);
    int number = 1;
    try {
        for (; std::cin.getline(line.data(), static_cast<std::streamsize>(line.size())); ++number) {
            std::vector<std::string> arguments{"--headless"};
            std::istringstream words(line.data());
            for (std::string word; words >> std::quoted(word);) arguments.push_back(word);
            if (arguments.size() > 1) commands.run(arguments);
            if (is_interrupted()) throw UserError("interrupted: the lines after it were not run");
            std::cout << "line " << number << " is done" << std::endl;
        }
        if (!std::cin.eof()) throw UserError("is longer than " + std::to_string(line.size() - 1) + " bytes");
        return 0;
    } catch (const std::exception& error) {
        return report(error, "line " + std::to_string(number) + " of the standard input: ");
    }
}

}  // namespace

int run_chapter(const std::string& name, int argument_count, char** arguments) {
    prepare_program();
    try {
        const Chapter chapter = load_chapter(name);
        Commands commands(chapter);
        const std::vector<std::string> given(arguments + 1, arguments + argument_count);
        if (given == std::vector<std::string>{"--batch"}) return run_batch(commands);
        commands.run(given);
        return 0;
    } catch (const std::exception& error) {
        return report(error);
    }
}

}  // namespace lab
