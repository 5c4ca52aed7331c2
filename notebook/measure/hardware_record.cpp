// Measures the backends of a device and writes a JSON record for docs/results.md: paths and rays per second of the benchmark's
// estimator on three sizes of scene and of the last chapter on two shipped scenes, and the bare rate at which each backend traces
// exactly the same rays.
#include <cstdio>

#include "files/file.h"
#include "files/project_folder.h"
#include "measure/box_scene.h"
#include "measure/measurement.h"
#include "measure/rates.h"
#include "measure/replay/recorded_ray.h"
#include "rendering/settings.h"
#include "scene/scene_file.h"

namespace lab {
namespace {

// Index of the path in the order of the film's blocks, as each backend's main program computes it. The n-th rays of neighbouring
// paths are adjacent in memory.
std::vector<std::string> path_defines(Backend backend, size_t path_count) {
    const std::string index =
        backend == pipeline_backend ? "gl_LaunchIDEXT.x" : "gl_WorkGroupID.x * 64u + gl_LocalInvocationIndex";
    return {"PATH_INDEX (dispatch.first_block * 64u + " + index + ")", "PATH_COUNT " + std::to_string(path_count) + "u"};
}

// What to measure: a scene, and an estimator whose paths have at most eight bounces.
struct Subject {
    std::string name;
    Scene scene;
    Estimator estimator;
    RenderParameters parameters;
};

Subject benchmark_subject(uint32_t size, uint32_t segments, uint32_t rings) {
    Scene scene = make_box_scene(segments, rings);
    const RenderParameters parameters = default_parameters(scene, uvec2(size));
    return {"box with a sphere", std::move(scene), {project_folder() / "notebook/measure/path_trace.glsl"}, parameters};
}

Subject chapter_subject(uint32_t size, const std::string& scene_name) {
    const Chapter chapter = load_chapter(chapter_folders().back());
    Options options;
    options.image.width = options.image.height = size;
    options.light.max_path_length = 8;
    options.samples.chapter_values.resize(chapter.options.size());  // all defaults
    Scene scene = load_scene(project_folder() / "assets/scenes" / (scene_name + ".json"));
    const RenderParameters parameters = make_parameters(chapter, scene, options);
    return {scene_name, std::move(scene), estimator_of(chapter), parameters};
}

json measure(const Device& device, const Subject& subject) {
    const auto& [name, scene, estimator, parameters] = subject;
    const auto measure = project_folder() / "notebook/measure";
    const uint32_t size = parameters.image_size.x;
    const GpuScene gpu_scene(device, scene);
    const size_t path_count = size_t{(size + 7) / 8 * 8} * ((size + 7) / 8 * 8);  // blocks at the border count in full
    const Buffer rays(device, path_count * MAX_RECORDED_RAYS * sizeof(RecordedRay), vk::BufferUsageFlagBits::eStorageBuffer);
    device.submit([&](const vk::raii::CommandBuffer& commands) { commands.fillBuffer(rays.handle(), 0, VK_WHOLE_SIZE, 0); });
    const Binding ray_binding = storage_binding(BINDING_RECORDED_RAYS, rays);
    {
        const auto scene_backend = compute_backend->build(device, gpu_scene);
        Estimator record{measure / "record_rays.glsl", path_defines(compute_backend, path_count), estimator.file};
        record.defines.insert(record.defines.end(), estimator.defines.begin(), estimator.defines.end());
        Renderer recorder(device, *scene_backend, record, parameters, {&ray_binding, 1});
        while (recorder.advance(1)) {
        }
    }

    json result{{"scene", name},
                {"estimator", estimator.file.lexically_relative(project_folder()).generic_string()},
                {"triangles", scene.triangles.size()},
                {"backends", json::object()}};
    for (const Backend backend : all_backends) {
        if (!is_supported(backend, device.description())) continue;
        const auto scene_backend = backend->build(device, gpu_scene);
        Renderer path_tracer(device, *scene_backend, estimator, parameters);
        const Estimator replay{measure / "replay/path_trace.glsl", path_defines(backend, path_count)};
        Renderer replayer(device, *scene_backend, replay, parameters, {&ray_binding, 1});
        const auto runs = measure_in_turns({&path_tracer, &replayer}, 0.5);
        const Rates rates = median(runs[0]), bare = median(runs[1]);
        json all_runs{{"rays_per_second", json::array()}, {"bare_rays_per_second", json::array()}};
        for (const Rates& run : runs[0]) all_runs["rays_per_second"].push_back(run.rays_per_second);
        for (const Rates& run : runs[1]) all_runs["bare_rays_per_second"].push_back(run.rays_per_second);
        result["backends"][to_string(backend)] = {
            {"paths_per_second", rates.paths_per_second},   {"rays_per_second", rates.rays_per_second},
            {"bare_rays_per_second", bare.rays_per_second}, {"runs", all_runs},
            {"structure_bytes", scene_backend->bytes()},    {"structure_seconds", scene_backend->build_seconds()}};
        std::printf(
            "%-17s %8zu triangles  %-8s %8.1f million paths/s  %8.1f million rays/s, bare %8.1f (%.2f of "
            "it)\n",
            name.c_str(), scene.triangles.size(), to_string(backend).c_str(), 1e-6 * rates.paths_per_second,
            1e-6 * rates.rays_per_second, 1e-6 * bare.rays_per_second, rates.rays_per_second / bare.rays_per_second);
        std::fflush(stdout);
    }
    return result;
}

int run(const RecordSettings& settings) {
    check_writable(settings.output, {".json"});  // fail before spending minutes
    const Device device({.choice = settings.device});
    const uint32_t size = settings.size;
    const auto& description = device.description();
    std::printf("%s, %s, %ux%u pixels\n", description.name.c_str(), description.driver.c_str(), size, size);
    json record = record_of(device);
    record["size"] = size;
    constexpr std::pair<uint32_t, uint32_t> spheres[] = {{5, 3}, {200, 100}, {1400, 700}};
    for (const auto& [segments, rings] : spheres)
        record["scenes"].push_back(measure(device, benchmark_subject(size, segments, rings)));
    for (const char* scene : {"cornell_box", "heart_light"})
        record["scenes"].push_back(measure(device, chapter_subject(size, scene)));
    write_file(settings.output, record.dump(2) + "\n");
    return 0;
}

}  // namespace
}  // namespace lab

int main(int argument_count, char** arguments) {
    CLI::App app("Measures the backends of a device and writes a JSON record");
    lab::RecordSettings settings{.size = 1024, .output = "hardware.json"};
    add_record_options(app, settings);
    return lab::run_measurement(app, argument_count, arguments, [&] { return lab::run(settings); });
}
