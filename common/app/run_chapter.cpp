#include "app/run_chapter.h"

#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "app/headless.h"
#include "error.h"
#include "files/file.h"
#include "rendering/backend_choice.h"
#include "rendering/settings.h"
#include "viewer/viewer.h"

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

// Room for the picture and the controls, on a screen of common size.
uvec2 window_size(uvec2 image_size) {
    return glm::clamp(image_size + uvec2(360, 0), uvec2(900, 700), uvec2(1600, 1000));
}

// The window that is wanted, or null. One that nobody has asked for opens for people only, since scripts read
// what is printed, and only where it can.
std::unique_ptr<Window> open_window(const Chapter& chapter, const Options& options, uvec2 image_size) {
    const bool is_forced = options.window == WindowChoice::always;
    if (options.window == WindowChoice::never) return nullptr;
    if (!is_forced &&
        (!Window::has_display() || !isatty(STDOUT_FILENO) || needs_no_window(options) || options.quiet))
        return nullptr;
    try {
        return std::make_unique<Window>(chapter.name, window_size(image_size));
    } catch (const UserError& error) {
        if (is_forced) throw;
        std::cerr << "note: " << error.what() << "\n";
        return nullptr;
    }
}

// Opens the window's chapter if the device can show pictures in it; false if it cannot.
bool run_in_window(Window& window, const Chapter& chapter, const Options& options, Scene& scene) {
    const Device device({.choice = options.device,
                         .validation = options.validation,
                         .instance_extensions = window.instance_extensions(),
                         .make_surface = [&](VkInstance instance) { return window.make_surface(instance); }});
    if (*device.surface()) {
        run_viewer(window, device, chapter, options, std::move(scene));
        check_validation(device, options);
        return true;
    }
    const std::string why = "device '" + device.description().name + "' cannot show pictures in a window";
    if (options.window == WindowChoice::always)
        throw DeviceError(why + ": choose another with --device or use --headless");
    std::cerr << "note: " << why << ": rendering without one\n";
    return false;
}

void run(const Chapter& chapter, const Options& options) {
    check_outputs(options);
    Scene scene = load_scene(options.scene, options.specular);
    check_scene(chapter, scene);
    for (const auto& warning : scene.warnings)
        if (!options.quiet) std::cerr << "note: " << warning << "\n";
    const Estimator estimator = make_estimator(chapter, options);
    RenderJob job = make_job(chapter, scene, estimator, options);

    if (const auto window = open_window(chapter, options, job.parameters.image_size);
        window && run_in_window(*window, chapter, options, scene))
        return;

    const Device device({options.device, options.validation});
    // Before the scene takes time and memory.
    require_memory(device, Renderer::memory_needs(job.parameters.image_size));
    const bool samples_lights = chapter.light_sampling && options.light_sampling && !options.view;
    const GpuScene gpu_scene(device, scene, samples_lights ? LightSampling::on : LightSampling::off);
    const Backend backend = choose_backend(options, device, gpu_scene, estimator, job.parameters);
    const auto acceleration_structure = build_acceleration_structure(backend, device, gpu_scene);
    job.acceleration = {acceleration_structure->bytes(), acceleration_structure->build_seconds()};
    record_device(job, device.description().name, to_string(backend));
    if (!options.quiet)
        std::cout << chapter.name << ", " << job.record.scene << ", " << job.parameters.image_size.x << "x"
                  << job.parameters.image_size.y << ", " << job.samples << " samples, "
                  << device.description().name << ", backend " << to_string(backend) << std::endl;
    if (!options.quiet && chapter.unlimited_path_length && !options.max_path_length &&
        !options.split_every_hit)
        std::cout << "path length    " << safety_limit_text(scene) << std::endl;
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
