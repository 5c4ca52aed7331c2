// Measures what the ways to sample a rough surface cost and what its single scattering loses, by roughness, and writes a JSON
// record for the page of the chapter on microfacets.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "files/file.h"
#include "measure/measurement.h"
#include "rendering/options.h"
#include "rendering/renderer.h"
#include "rendering/settings.h"
#include "statistics/error_metrics.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

constexpr double sampled_roughnesses[] = {0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1};
constexpr double furnace_roughnesses[] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1};
constexpr double furnace_degrees[] = {0, 45, 80};

struct Settings : RecordSettings {
    uint32_t samples = 64;
    uint32_t runs = 8;
};

// A scene on the device, and its renderer.
class Subject {
  public:
    Subject(const Device& device, const Chapter& chapter, const Scene& scene)
        : device_(device),
          chapter_(chapter),
          scene_(scene),
          gpu_scene_(device, scene, Strategy::both, chapter.handles),
          scene_backend_(compute_backend->build(device, gpu_scene_)) {}

    Renderer renderer(const Options& options) const {
        return {device_, *scene_backend_, make_estimator(chapter_, options), parameters(options)};
    }

    RenderParameters parameters(const Options& options) const { return make_parameters(chapter_, scene_, options); }

  private:
    const Device& device_;
    const Chapter& chapter_;
    const Scene& scene_;
    GpuScene gpu_scene_;
    std::unique_ptr<SceneBackend> scene_backend_;
};

Options options_of(const Chapter& chapter, uint32_t size) {
    Options options;
    options.image.width = options.image.height = size;
    options.samples.chapter_values.resize(chapter.options.size());
    return options;
}

// Error and seconds of each sampling strategy; the strategies take turns.
json measure_sampling(const Device& device, const Chapter& chapter, double roughness, const Settings& settings) {
    Scene scene = load_shipped_scene("studio.json");
    make_metal(scene, static_cast<float>(roughness));
    const Subject subject(device, chapter, scene);
    const ChapterChoice& ways = chapter.choices.front();
    json row{{"roughness", roughness}, {"ways", json::object()}};
    Options options = options_of(chapter, settings.size);
    options.light.max_path_length = 8;
    std::vector<std::unique_ptr<Renderer>> renderers;
    for (size_t i = 0; i < ways.values.size(); ++i) {
        options.estimator.choices[ways.name] = i;
        renderers.push_back(std::make_unique<Renderer>(subject.renderer(options)));
        row["ways"][ways.values[i].first] = {{"errors", json::array()}, {"device_seconds", json::array()}};
    }
    for (uint32_t seed = 0; seed <= settings.runs; ++seed)
        for (size_t i = 0; i < ways.values.size(); ++i) {
            Renderer& renderer = *renderers[i];
            options.samples.seed = seed;
            renderer.restart(subject.parameters(options));
            while (renderer.advance(settings.samples)) {
            }
            if (seed == 0) continue;  // warms up
            json& way = row["ways"][ways.values[i].first];
            way["errors"].push_back(estimate_error(renderer.film().read())->rel_mse);
            way["device_seconds"].push_back(renderer.device_seconds());
        }
    return row;
}

// What white metal under a white sky reflects to a camera at some angle to its normal, with and without light that facets reflect
// to each other.
json measure_furnace(const Device& device, const Chapter& chapter, double roughness, double degrees, const Settings& settings) {
    Scene scene = make_scene({diffuse_material(vec3(1))}, {{vec3(-9, 0, 9), vec3(18, 0, 0), vec3(0, 0, -18)}});
    scene.background = vec3(1);
    make_metal(scene, static_cast<float>(roughness));
    Options options = options_of(chapter, settings.size);
    options.light.max_path_length = 1;
    const double angle = degrees * std::numbers::pi / 180;
    options.camera.position = vec3(glm::dvec3(0, std::cos(angle), std::sin(angle)));
    options.camera.target = vec3(0);
    options.camera.up = vec3(1, 0, 0);
    options.camera.vertical_fov = 1.0f;
    json row{{"roughness", roughness}, {"degrees", degrees}};
    for (const bool is_corrected : {false, true}) {
        scene.multiple_scattering = is_corrected;
        const Subject subject(device, chapter, scene);
        Renderer renderer = subject.renderer(options);
        while (renderer.advance(settings.samples)) {
        }
        const NoiseEstimate noise = estimate_noise(renderer.film().read(), {0, 0}, uvec2(settings.size));
        row[is_corrected ? "corrected" : "single"] = {{"reflected", noise.mean.g},
                                                      {"standard_error", noise.standard_error / settings.size}};
    }
    return row;
}

int run(const Settings& settings) {
    check_writable(settings.output, {".json"});  // fail before spending minutes
    const Device device({.choice = settings.device});
    const Chapter chapter = load_chapter(chapter_named("microfacets"));
    json record = record_of(device);
    record.update({{"chapter", chapter.name}, {"scene", "studio"}, {"size", settings.size}, {"samples", settings.samples}});
    for (const double roughness : sampled_roughnesses) {
        record["sampling"].push_back(measure_sampling(device, chapter, roughness, settings));
        std::printf("%s\n", record["sampling"].back().dump().c_str());
        std::fflush(stdout);
    }
    for (const double roughness : furnace_roughnesses)
        for (const double degrees : furnace_degrees) {
            record["furnace"].push_back(measure_furnace(device, chapter, roughness, degrees, settings));
            std::printf("%s\n", record["furnace"].back().dump().c_str());
        }
    write_file(settings.output, record.dump(1) + "\n");
    return 0;
}

}  // namespace
}  // namespace lab

int main(int argument_count, char** arguments) {
    CLI::App app("Measures the ways to sample microfacets and what these lose, and writes a JSON record");
    lab::Settings settings{{.size = 128, .output = "facets.json"}};
    add_record_options(app, settings);
    app.add_option("--samples", settings.samples, "Per pixel, of a run")->check(CLI::Range(2, 1 << 20))->capture_default_str();
    app.add_option("--runs", settings.runs, "Of each way to sample, beside one that warms up")
        ->check(CLI::Range(2, 1000))
        ->capture_default_str();
    return lab::run_measurement(app, argument_count, arguments, [&] { return lab::run(settings); });
}
