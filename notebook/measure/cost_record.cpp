// Measures what each scene feature costs and how cost grows with the number of triangles, lights and so on, and writes a JSON
// record for docs/results.md.
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <thread>

#include "error.h"
#include "files/file.h"
#include "files/project_folder.h"
#include "measure/box_scene.h"
#include "measure/growth.h"
#include "measure/measurement.h"
#include "measure/rates.h"
#include "support/render.h"
#include "support/scene_features.h"
#include "support/scenes.h"
#include "support/shader_code.h"

namespace lab {
namespace {

struct Options : RecordSettings {
    double seconds = 0.2;
    uint64_t largest = 4'194'304;
};

// Bytes of each array and image of a scene on the device.
json bytes_of(const GpuScene& scene) {
    json bytes = json::object();
    for (const auto& need : scene.memory_needs()) bytes[need.what] = bytes.value(need.what, size_t{0}) + need.bytes;
    return bytes;
}

// Device memory of the shipped scenes.
json describe_shipped_scenes(const Device& device) {
    json scenes = json::array();
    for (const auto& file : sorted_entries(project_folder() / "assets/scenes")) {
        const Scene scene = load_scene(file);
        scenes.push_back({{"scene", file.stem()},
                          {"triangles", scene.triangles.size()},
                          {"instances", scene.instances.size()},
                          {"bytes", bytes_of(GpuScene(device, scene))}});
    }
    return scenes;
}

// A scene ready to be rendered.
class Subject {
  public:
    Subject(const Device& device, Backend backend, const std::string& chapter, const GrowthStep& step)
        : scene_(step.scene), gpu_scene_(device, scene_), estimator_(chapter_estimator(chapter)) {
        scene_backend_ = backend->build(device, gpu_scene_);
        RenderParameters parameters = default_parameters(scene_, step.image_size);
        parameters.max_path_length = step.max_path_length;
        parameters.roulette_start = 1;
        renderer_.emplace(device, *scene_backend_, estimator_, parameters);
        film_bytes_ = Film::memory_need(step.image_size.x, step.image_size.y).bytes;
    }

    Renderer& renderer() { return *renderer_; }

    json describe(const std::vector<Rates>& runs) const {
        json result{{"rays_per_path", median(runs).rays_per_second / median(runs).paths_per_second},
                    {"structure_bytes", scene_backend_->bytes()},
                    {"structure_seconds", scene_backend_->build_seconds()},
                    {"film_bytes", film_bytes_},
                    {"bytes", bytes_of(gpu_scene_)},
                    {"paths_per_second", json::array()}};
        for (const Rates& run : runs) result["paths_per_second"].push_back(run.paths_per_second);
        return result;
    }

    size_t instructions() const {
        ShaderCode code;
        for (const auto& shader : scene_backend_->shaders(estimator_)) code.merge(read_code(shader));
        return code.instructions;
    }

  private:
    Scene scene_;
    GpuScene gpu_scene_;
    Estimator estimator_;
    std::unique_ptr<SceneBackend> scene_backend_;
    size_t film_bytes_;
    std::optional<Renderer> renderer_;
};

using Subjects = std::vector<std::unique_ptr<Subject>>;

std::vector<std::vector<Rates>> measure(const Subjects& subjects, const Options& options) {
    std::vector<Renderer*> renderers;
    for (const auto& subject : subjects) renderers.push_back(&subject->renderer());
    return measure_in_turns(renderers, options.seconds);
}

void print(const std::string& what, Backend backend, const std::vector<Rates>& runs, const std::vector<Rates>& base) {
    std::printf("%-48s %-8s %9.4g million paths/s, time x %.3f\n", what.c_str(), to_string(backend).c_str(),
                1e-6 * median(runs).paths_per_second, median(base).paths_per_second / median(runs).paths_per_second);
    std::fflush(stdout);
}

// Each feature alone, and none, in the box without light. Chapter 6 supports all of them.
json measure_features(const Device& device, Backend backend, const Options& options) {
    const std::string chapter = chapter_named("dielectrics");
    Scene bare = make_box_scene(200, 100);
    for (Material& material : bare.materials) material.emission = vec3(0);
    std::vector<std::string> names{"none"};
    Subjects subjects;
    const auto add = [&](const Scene& scene) {
        const GrowthStep step{0, scene, uvec2(options.size), scene.defaults.max_path_length};
        subjects.push_back(std::make_unique<Subject>(device, backend, chapter, step));
    };
    add(bare);
    for (const SceneFeature& feature : all_scene_features()) {
        Scene scene = bare;
        feature.add(scene);
        names.push_back(feature.name);
        add(scene);
    }
    const auto rates = measure(subjects, options);
    json rows = json::array();
    for (size_t i = 0; i < subjects.size(); ++i) {
        json row{{"feature", names[i]}, {"instructions", subjects[i]->instructions()}};
        row.update(subjects[i]->describe(rates[i]));
        rows.push_back(row);
        print(names[i], backend, rates[i], rates[0]);
    }
    return {{"backend", to_string(backend)}, {"chapter", chapter}, {"rows", rows}};
}

json measure_growth(const Device& device, Backend backend, const Growth& growth, const Options& options) {
    std::vector<uint64_t> counts;
    Subjects subjects;
    for (const uint64_t count : growth.counts)
        if (counts.empty() || count <= options.largest) {
            const GrowthStep step = growth.make(count);
            try {
                subjects.push_back(std::make_unique<Subject>(device, backend, growth.chapter, step));
            } catch (const DeviceFailure& failure) {
                std::printf("%s %s: %s\n", std::to_string(step.count).c_str(), growth.quantity.c_str(), failure.what());
                break;
            }
            counts.push_back(step.count);
        }
    const auto rates = measure(subjects, options);
    json rows = json::array();
    for (size_t i = 0; i < subjects.size(); ++i) {
        json row{{"count", counts[i]}};
        row.update(subjects[i]->describe(rates[i]));
        rows.push_back(row);
        print(std::to_string(counts[i]) + " " + growth.quantity, backend, rates[i], rates[0]);
    }
    return {{"backend", to_string(backend)}, {"quantity", growth.quantity}, {"chapter", growth.chapter}, {"rows", rows}};
}

int run(const Options& options) {
    check_writable(options.output, {".json"});  // fail before spending minutes
    const Device device({.choice = options.device});
    const auto& description = device.description();
    std::printf("%s, %s, %ux%u pixels\n", description.name.c_str(), description.driver.c_str(), options.size, options.size);
    json record = record_of(device);
    record["cpu_threads"] = std::thread::hardware_concurrency();
    record["size"] = options.size;
    record["seconds_per_run"] = options.seconds;
    record["scenes"] = describe_shipped_scenes(device);
    std::vector<Backend> backends;
    std::copy_if(std::begin(all_backends), std::end(all_backends), std::back_inserter(backends), [&](Backend backend) {
        return is_supported(backend, description) && (backend != native_backend || description.kind == "CPU");
    });
    for (const Backend backend : backends)
        if (backend != native_backend)  // which has no SPIR-V to count
            record["features"].push_back(measure_features(device, backend, options));
    for (const Growth& growth : all_growths(options.size))
        for (const Backend backend : backends) record["growth"].push_back(measure_growth(device, backend, growth, options));
    write_file(options.output, record.dump(1) + "\n");
    return 0;
}

}  // namespace
}  // namespace lab

int main(int argument_count, char** arguments) {
    CLI::App app("Measures what features cost and how cost grows, and writes a JSON record");
    lab::Options options{{.size = 256, .output = "cost.json"}};
    add_record_options(app, options);
    app.add_option("--seconds", options.seconds, "Device time of a run: of each there are five, and one that warms up")
        ->check(CLI::Range(0.001, 100.0))
        ->capture_default_str();
    app.add_option("--largest", options.largest, "Largest number of triangles, pixels and so on")->capture_default_str();
    return lab::run_measurement(app, argument_count, arguments, [&] { return lab::run(options); });
}
