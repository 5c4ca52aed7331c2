// Paths per second of the `compute` backend, compared with `native`, whose rays are traced by Embree if that is installed.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "error.h"
#include "files/project_folder.h"
#include "measure/box_scene.h"
#include "measure/measurement.h"
#include "rendering/renderer.h"

namespace lab {
namespace {

struct Options {
    uint32_t runs = 5;
    uint32_t size = 256;
    uint32_t samples = 16;
    std::string device;
};

using Runs = std::vector<double>;  // million paths per second

double median(Runs runs) {
    std::sort(runs.begin(), runs.end());
    return runs[runs.size() / 2];
}

// A backend that renders the scene.
struct Side {
    Side(Backend which, const Device& device, const GpuScene& scene, const RenderParameters& parameters)
        : backend(which),
          scene_backend(which->build(device, scene)),
          renderer(device, *scene_backend, {project_folder() / "notebook/measure/path_trace.glsl"}, parameters) {
        renderer.set_dispatch_seconds(1);
    }
    glm::dvec3 mean() const {
        const auto mean = renderer.film().read().mean_radiance();
        return {mean[0], mean[1], mean[2]};
    }

    Backend backend;
    std::unique_ptr<SceneBackend> scene_backend;
    Renderer renderer;
    Runs runs;
};

void print(const Side& side) {
    std::printf("  %-7s median %8.3f million paths/s; runs:", to_string(side.backend).c_str(), median(side.runs));
    for (const double run : side.runs) std::printf(" %.3f", run);
    const auto mean = side.mean();
    std::printf("; image mean %.5f %.5f %.5f\n", mean.r, mean.g, mean.b);
}

// Renders with all threads or the device, once to warm up and then alternately.
void compare(const Device& device, const Options& options, uint32_t segments, uint32_t rings) {
    const Scene scene = make_box_scene(segments, rings);
    std::printf("%zu triangles\n", scene.triangles.size());
    RenderParameters parameters{};
    parameters.camera = make_camera(scene.camera, options.size, options.size);
    parameters.image_size = uvec2(options.size);
    parameters.seed_key = seed_key(1);
    parameters.max_path_length = 8;
    parameters.only_path_length = -1;

    const GpuScene gpu_scene(device, scene);
    std::vector<Side> sides;
    for (const Backend backend : {compute_backend, native_backend})
        if (is_supported(backend, device.description())) sides.emplace_back(backend, device, gpu_scene, parameters);
    for (uint32_t run = 0; run <= options.runs; ++run)
        for (Side& side : sides) {
            const auto start = std::chrono::steady_clock::now();
            while (side.renderer.advance((run + 1) * options.samples)) continue;
            const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            if (run > 0) side.runs.push_back(1e-6 * options.size * options.size * options.samples / seconds);
        }
    for (const Side& side : sides) print(side);
    if (sides.size() < 2) return;
    Runs ratios;
    for (size_t i = 0; i < options.runs; ++i) ratios.push_back(sides[0].runs[i] / sides[1].runs[i]);
    const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
    const auto difference = sides[0].mean() / sides[1].mean() - 1.0;
    std::printf("  compute / native %.3f (%.3f to %.3f); relative difference of the means %.1e %.1e %.1e\n", median(ratios),
                *least, *most, difference.r, difference.g, difference.b);
}

int run(const Options& options) {
    const Device device({.choice = options.device});
    std::printf("%s, %s\n", device.description().name.c_str(), device.description().driver.c_str());
    compare(device, options, 5, 3);
    compare(device, options, 200, 100);
    compare(device, options, 1400, 700);
    return 0;
}

}  // namespace
}  // namespace lab

int main(int argc, char** argv) {
    lab::Options options;
    CLI::App app("Measures the traversal of the compute backend on boxes of 32, 39,612 and 1,957,212 triangles.");
    app.add_option("--runs", options.runs, "Measured runs of each")->check(CLI::Range(1, 1000))->capture_default_str();
    app.add_option("--size", options.size, "Image width and height")->check(CLI::Range(8, 8192))->capture_default_str();
    app.add_option("--samples", options.samples, "Samples per pixel and run")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--device", options.device, "Index or part of the name of a Vulkan device");
    return lab::run_measurement(app, argc, argv, [&] { return lab::run(options); });
}
