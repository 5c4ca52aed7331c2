// The command line, the same for every chapter.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "film/film_image.h"
#include "gpu/shader_compiler.h"
#include "rendering/chapter.h"
#include "scene/scene.h"
#include "tracing/backend.h"

namespace lab {

// A picture of something other than radiance: by the file `observer` of shaders/observation/ with `define`, if it has one.
struct View {
    std::string name;
    std::string define;
    DisplayTransform display;
    std::string observer = "view.glsl";
    bool is_special = false;  // only backends that name it among their special_views can show it
};

// The scene files in assets/scenes, sorted by name; empty without that folder.
std::vector<std::filesystem::path> shipped_scenes();

const std::vector<View>& views();

// Whether to open a window; automatic: if there is a terminal and a display.
enum class WindowChoice { automatic, always, never };

// Options that decide which files are read.
struct SceneOptions {
    std::filesystem::path file;
    bool specular = false;
    bool operator==(const SceneOptions&) const = default;
};

// Options that decide how the chapter's estimator is compiled.
struct EstimatorOptions {
    std::optional<Strategy> strategy;       // one of the chapter's
    std::map<std::string, size_t> choices;  // name of a chapter's choice -> index of its value
    Replacements shaders;                   // that are read instead of those in chapters/
    std::optional<uint32_t> max_threads_per_pixel;
    bool operator==(const EstimatorOptions&) const = default;
};

struct ImageOptions {
    std::optional<uint32_t> width, height;
    const View* view = nullptr;  // null: radiance
    DisplayTransform display() const { return view ? view->display : DisplayTransform::exposure; }
    bool operator==(const ImageOptions&) const = default;
};

struct CameraOptions {
    std::optional<vec3> position, target, up;
    std::optional<float> vertical_fov;  // degrees
    std::optional<float> aperture_diameter, focus_distance;
    bool operator==(const CameraOptions&) const = default;
};

// Options for the light in the picture.
struct LightOptions {
    std::optional<vec3> background;
    std::optional<uint32_t> max_path_length, only_path_length;
    bool operator==(const LightOptions&) const = default;
};

// Options that change samples, but not their expectation.
struct SampleOptions {
    uint32_t seed = 1;
    uint32_t first_sample = 0;
    std::vector<std::optional<double>> chapter_values;  // per option of the chapter, if given
    bool operator==(const SampleOptions&) const = default;
};

// Options that change no sample.
struct AppearanceOptions {
    std::optional<uint32_t> sample_count;  // per pixel
    float exposure = 0;                    // stops
    bool operator==(const AppearanceOptions&) const = default;
};

// Device, outputs and limits of the run.
struct RunOptions {
    std::span<const Backend> backends;  // of the program
    std::string backend = "auto";       // a name among theirs
    std::string device;
    bool list_devices = false;
    std::vector<std::filesystem::path> outputs;
    bool has_default_outputs = false;  // not named by the user
    std::filesystem::path reference;
    std::filesystem::path report;
    std::optional<double> target_error;  // square root of rel_mse
    std::optional<double> time_limit;    // seconds
    std::filesystem::path resume;
    std::optional<double> save_every;  // seconds
    WindowChoice window = WindowChoice::automatic;
    bool validation = false;
    bool sanitize = false;
    std::optional<uvec2> debug_pixel;  // renders only this one, for a debugger
    bool quiet = false;
    bool batch = false;  // more command lines are in the standard input
};

// In groups that can be compared and copied as a whole.
struct Options {
    SceneOptions scene;
    EstimatorOptions estimator;
    ImageOptions image;
    CameraOptions camera;
    LightOptions light;
    SampleOptions samples;
    AppearanceOptions appearance;
    RunOptions run;
};

// Whether options ask for measurements or limits, which only headless runs support.
bool needs_no_window(const Options& options);

// Parses the arguments of a command line. Prints and returns nothing for --help and --version. Throws UserError for anything it
// does not understand.
std::optional<Options> parse_options(const Chapter& chapter, std::span<const Backend> backends,
                                     const std::vector<std::string>& arguments);

}  // namespace lab
