// Paths per second of the `compute` backend, compared with a native twin of the same estimator that uses Embree.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "error.h"
#include "files/project_folder.h"
#include "measure/box_scene.h"
#include "measure/measurement.h"
#include "rendering/renderer.h"
#ifdef EMBREE_VERSION
#include "measure/embree_twin.h"
#endif

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

void print(const char* name, const Runs& runs, const glm::dvec3& mean) {
    std::printf("  %-7s median %8.3f million paths/s; runs:", name, median(runs));
    for (const double run : runs) std::printf(" %.3f", run);
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
    const auto timed = [&](const auto& render) {
        const auto start = std::chrono::steady_clock::now();
        render();
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return 1e-6 * options.size * options.size * options.samples / seconds;
    };

    const GpuScene gpu_scene(device, scene);
    const auto acceleration_structure = build_acceleration_structure(Backend::compute, device, gpu_scene);
    Renderer renderer(device, *acceleration_structure, {project_folder() / "tests/measure/path_trace.glsl"}, parameters);
    renderer.set_dispatch_seconds(1);
#ifdef EMBREE_VERSION
    EmbreeTwin twin(scene, parameters);
#endif
    Runs device_runs, twin_runs;
    for (uint32_t run = 0; run <= options.runs; ++run) {
        const uint32_t target = (run + 1) * options.samples;
        device_runs.push_back(timed([&] {
            while (renderer.advance(target)) continue;
        }));
#ifdef EMBREE_VERSION
        twin_runs.push_back(timed([&] { twin.advance(target); }));
#endif
    }
    device_runs.erase(device_runs.begin());
    const auto mean = renderer.film().read().mean_radiance();
    print("device", device_runs, {mean[0], mean[1], mean[2]});
#ifdef EMBREE_VERSION
    twin_runs.erase(twin_runs.begin());
    const glm::dvec3 twin_mean = twin.mean();
    print("twin", twin_runs, twin_mean);
    const glm::dvec3 difference = glm::dvec3(mean[0], mean[1], mean[2]) / twin_mean - 1.0;
    Runs ratios;
    for (size_t i = 0; i < device_runs.size(); ++i) ratios.push_back(device_runs[i] / twin_runs[i]);
    const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
    std::printf("  device / twin %.3f (%.3f to %.3f); relative difference of the means %.1e %.1e %.1e\n", median(ratios), *least,
                *most, difference.r, difference.g, difference.b);
#endif
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
