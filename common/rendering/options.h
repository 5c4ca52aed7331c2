// The command line, the same for every chapter.
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "film/display.h"
#include "rendering/chapter.h"
#include "scene/scene.h"

namespace lab {

// A picture of something else than radiance: what shaders/view.glsl shows when `define` is defined.
struct View {
    std::string name;
    std::string define;
    DisplayTransform display;
};
const std::vector<View>& views();

// Whether a window opens: yes, no, or where there is a display and someone at a terminal who can see it.
enum class WindowChoice { automatic, always, never };

struct Options {
    std::filesystem::path scene;
    std::optional<uint32_t> width, height, samples, max_path_length;
    std::optional<uint32_t> only_path_length;
    uint32_t seed = 1;
    uint32_t first_sample = 0;
    std::string backend = "auto";
    std::string device;
    bool list_devices = false;
    std::vector<std::filesystem::path> outputs;
    std::filesystem::path reference;
    std::filesystem::path report;
    std::optional<double> target_error;  // square root of rel_mse
    std::optional<double> time_limit;    // seconds
    const View* view = nullptr;
    std::optional<std::array<float, 3>> camera_position, camera_target, camera_up, background;
    std::optional<float> vertical_fov;  // degrees
    bool specular = false;
    bool light_sampling = true;
    bool split_every_hit = false;
    std::vector<std::optional<double>> chapter_values;  // one for each of the chapter's options, if given
    float exposure = 0;                                 // stops
    std::filesystem::path resume;
    std::optional<double> save_every;  // seconds
    WindowChoice window = WindowChoice::automatic;
    bool validation = false;
    bool quiet = false;
};

// Whether it asks for what only a run without a window does: measurements and stopping by itself.
bool needs_no_window(const Options& options);

// Parses the command line. Returns nothing where the program is already done (--help, --version), after
// printing. Throws UserError with one line for anything it does not understand.
std::optional<Options> parse_options(const Chapter& chapter, int argument_count, char** arguments);

}  // namespace lab
