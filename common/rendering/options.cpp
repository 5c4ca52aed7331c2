#include "rendering/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <sstream>

#include "error.h"
#include "files/file.h"
#include "files/project_folder.h"
#include "rendering/settings.h"

namespace lab {
namespace {

// For transform(): a shell leaves the ~ of --output=~/a.png as it is.
CLI::Validator path_from_home() {
    return {[](std::string& path) {
                path = expand_home(path).string();
                return std::string();
            },
            "", "home"};
}

// Accepts finite numbers in [low, high]; CLI11 alone would also accept nan and inf.
CLI::Validator within(double low, double high, const std::string& what) {
    std::ostringstream range;
    range << what << " from " << low << " to " << high;
    return {[=, meaning = range.str()](std::string& text) -> std::string {
                char* end = nullptr;
                const double value = std::strtod(text.c_str(), &end);
                if (end != text.c_str() && *end == '\0' && value >= low && value <= high) return {};
                return "'" + text + "' is not " + meaning;
            },
            range.str()};
}

// For transform(): removes leading zeros, which would make the number octal.
CLI::Validator whole_number(uint32_t low, uint32_t high) {
    const std::string meaning = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
    return {[=](std::string& text) -> std::string {
                const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
                if (digits) text.erase(0, std::min(text.find_first_not_of('0'), text.size() - 1));
                if (digits && text.size() <= 10 && std::stoull(text) >= low && std::stoull(text) <= high) return {};
                return "'" + text + "' is not " + meaning;
            },
            meaning};
}

// "NAME=FILE" as the canonical path of the chapter's shader NAME, and FILE. make_estimator() checks that the chapter reads it.
std::pair<std::filesystem::path, std::filesystem::path> replacement(const Chapter& chapter, const std::string& text) {
    const size_t middle = std::min(text.find('='), text.size());
    const std::filesystem::path name = text.substr(0, middle), file = text.substr(std::min(middle + 1, text.size()));
    const auto chapters = project_folder() / "chapters";
    const auto place = std::filesystem::weakly_canonical((name.has_parent_path() ? chapters : chapters / chapter.name) / name);
    std::error_code ignored;  // names that the file system refuses
    const auto is_file = [&](const auto& path) { return std::filesystem::is_regular_file(path, ignored); };
    if (!is_file(file)) throw UserError("--shader " + text + ": there is no file " + in_quotes(file.string()));
    return {place, file};
}

// Options common to all chapters, in the order of --help.
void add_options(CLI::App& app, const Chapter& chapter, Options& options, std::string& view,
                 const std::vector<std::string>& backends) {
    auto& [scene, estimator, image, camera, light, samples, appearance, run] = options;
    constexpr uint32_t max_count = 4294967295u;
    const auto whole = [&](const char* name, auto& value, uint32_t low, uint32_t high, const std::string& help) {
        app.add_option(name, value, help)->transform(whole_number(low, high));
    };
    const auto number = [&](const char* name, auto& value, double low, double high, const char* what, const char* help) {
        app.add_option(name, value, help)->check(within(low, high, what));
    };
    const auto vector = [&](const char* name, std::optional<vec3>& value, double low, const char* what, const char* type,
                            const char* help) {
        const auto set = [&value](const std::array<float, 3>& given) { value = {given[0], given[1], given[2]}; };
        app.add_option_function<std::array<float, 3>>(name, set, help)
            ->delimiter(',')
            ->check(within(low, 1e30, what))
            ->type_name(type);
    };
    const auto place = [&](const char* name, std::optional<vec3>& value, const char* help) {
        vector(name, value, -1e30, "a number", "X,Y,Z", help);
    };
    std::vector<std::string> view_names;
    for (const auto& known : views()) view_names.push_back(known.name);

    const RenderDefaults defaults;
    const auto unless_given = [](uint32_t value) { return "; default: the scene's, or else " + std::to_string(value); };
    whole("--width", image.width, 1, max_image_extent, "Pixels in a row" + unless_given(defaults.width));
    whole("--height", image.height, 1, max_image_extent, "Pixels in a column" + unless_given(defaults.height));
    whole("--samples", appearance.sample_count, 1, max_count, "Samples per pixel" + unless_given(defaults.samples));
    whole("--seed", samples.seed, 0, max_count, "Chooses the random numbers");
    whole("--first-sample", samples.first_sample, 0, max_count, "Index of the first sample: splits a render into ranges");
    whole("--max-path-length", light.max_path_length, 0, path_length_limit,
          "Bounces after which a path ends, 0 for emission only" +
              unless_given(chapter.unlimited_path_length ? safety_limit : defaults.max_path_length));
    whole("--only-path-length", light.only_path_length, 0, path_length_limit, "Show only light after exactly this many bounces");
    number("--target-error", run.target_error, 1e-12, 1e12, "a number",
           "Stop when the relative error is below this: 0.01 is 1 %");
    number("--time-limit", run.time_limit, 1e-3, 1e9, "a number of seconds", "Stop after this many seconds");
    place("--camera-position", camera.position, "Where the camera stands");
    place("--camera-target", camera.target, "What it looks at");
    place("--camera-up", camera.up, "What it holds upwards");
    number("--vertical-fov", camera.vertical_fov, 1e-6, 179.999, "an angle",
           "Angle between the picture's top and bottom in degrees");
    number("--aperture-diameter", camera.aperture_diameter, 0, 1e18, "a length", "Diameter of the lens, 0 for a pinhole");
    number("--focus-distance", camera.focus_distance, 1e-30, 1e30, "a length (1e18 is infinity)",
           "From the lens to the plane in focus; default: the scene's, or else where the target is");
    vector("--background", light.background, 0, "a radiance", "R,G,B", "Radiance of the sky; with a light probe its factor");
    app.add_flag("--specular", scene.specular, "Use the Phong lobe Ks, Ns of the materials");
    app.add_option("--view", view, "Show something else than radiance")->check(CLI::IsMember(view_names));
    app.add_option("--output", run.outputs, "Picture to write (.exr .hdr .png .jpg); may be repeated")
        ->allow_extra_args(false)
        ->transform(path_from_home());
    number("--exposure", appearance.exposure, -100, 100, "a number", "Brightness of PNG and JPG in stops");
    app.add_option("--reference", run.reference, "EXR to compare with")->transform(path_from_home());
    app.add_option("--report", run.report, "Error against samples and seconds (.json or .csv)")->transform(path_from_home());
    app.add_option("--resume", run.resume, "EXR of an earlier run to continue")->transform(path_from_home());
    number("--save-every", run.save_every, 1e-3, 1e9, "a number of seconds", "Write the outputs every so many seconds");
    app.add_option("--backend", run.backend, "How rays are traced")->check(CLI::IsMember(backends));
    whole("--max-threads-per-pixel", estimator.max_threads_per_pixel, 1, max_count,
          "Threads that share a pixel of a small picture, at most; default: as many as keep the device busy");
    app.add_option_function<std::vector<std::string>>(
           "--shader",
           [&](const auto& given) {
               for (const auto& each : given) estimator.shaders.insert(replacement(chapter, each));
           },
           "Read FILE instead of the chapter's shader NAME, or CHAPTER/NAME of another chapter; may be repeated")
        ->allow_extra_args(false)
        ->type_name("NAME=FILE");
    app.add_option("--device", run.device, "Number or part of the name of the device");
    app.add_flag("--list-devices", run.list_devices, "Show the devices and what they lack");
    const auto window = [&](const char* name, WindowChoice choice, const char* help) {
        return app.add_flag_callback(
            name, [&options, choice] { options.run.window = choice; }, help);
    };
    auto* headless = window("--headless", WindowChoice::never, "Render without a window");
    window("--window", WindowChoice::always,
           "Open a window. This is the default at a terminal with a display, unless --report, --reference, "
           "--target-error, "
           "--time-limit, --save-every or --quiet is given")
        ->excludes(headless);
    app.add_flag("--validation", run.validation, "Check the use of Vulkan; any complaint is an error");
    app.add_flag("--sanitize", run.sanitize, "Stop at indices outside of their arrays, with the backend native");
    app.add_option_function<std::array<uint32_t, 2>>(
           "--debug-pixel",
           [&run](const auto& given) {
               run.debug_pixel = {given[0], given[1]};
           },
           "Compute only the first sample of this pixel, with the backend native: for debuggers, see ./lab debug")
        ->delimiter(',')
        ->type_name("X,Y");
    app.add_flag("--quiet", run.quiet, "Print errors only");
    app.add_flag("--batch", run.batch,
                 "Render several pictures: each line of the standard input is a command line like this one");
}

// Options of this chapter only.
void add_chapter_options(CLI::App& app, const Chapter& chapter, Options& options) {
    std::map<std::string, Strategy> strategies;
    for (const Strategy strategy : chapter.strategies) strategies[to_string(strategy)] = strategy;
    if (!strategies.empty())
        app.add_option_function<std::string>(
               "--strategy", [=, &options](const auto& name) { options.estimator.strategy = strategies.at(name); },
               "How light is found: by light samples, by bounces or by both")
            ->default_str(to_string(chapter.strategies.front()))
            ->check(CLI::IsMember(strategies));
    for (const ChapterChoice& choice : chapter.choices) {
        std::map<std::string, size_t> numbers;
        for (const auto& [value, _] : choice.values) numbers.emplace(value, numbers.size());
        app.add_option_function<std::string>(
               choice.name,
               [=, &given = options.estimator.choices[choice.name]](const auto& value) { given = numbers.at(value); },
               choice.help)
            ->default_str(choice.values.front().first)
            ->check(CLI::IsMember(numbers));
    }
    options.samples.chapter_values.resize(chapter.options.size());
    for (size_t i = 0; i < chapter.options.size(); ++i) {
        const ChapterOption& option = chapter.options[i];
        const bool is_whole = std::holds_alternative<uint32_t RenderParameters::*>(option.parameter);
        std::ostringstream default_value;
        default_value << option.default_value;
        app.add_option(option.name, options.samples.chapter_values[i], option.help)
            ->default_str(default_value.str())
            ->transform(is_whole ? whole_number(static_cast<uint32_t>(option.low), static_cast<uint32_t>(option.high))
                                 : within(option.low, option.high, "a number"));
    }
}

// Finds a scene by its path or by its name in assets/scenes.
std::filesystem::path find_scene(const std::string& name) {
    std::error_code ignored;  // names that the file system refuses are reported on reading
    const std::filesystem::path file = name;
    if (file.has_extension() || file.has_parent_path() || std::filesystem::is_regular_file(file, ignored)) return file;
    std::string names;
    for (const auto& shipped : shipped_scenes()) {
        if (shipped.stem() == name) return shipped;
        names += (names.empty() ? "" : ", ") + shipped.stem().string();
    }
    throw UserError(name + ": there is no such scene: name a .json or .obj file, or one of " + names);
}

}  // namespace

std::vector<std::filesystem::path> shipped_scenes() {
    std::vector<std::filesystem::path> scenes;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(project_folder() / "assets" / "scenes", ignored))
        if (entry.path().extension() == ".json") scenes.push_back(entry.path());
    std::sort(scenes.begin(), scenes.end());
    return scenes;
}

bool needs_no_window(const Options& options) {
    return !options.run.report.empty() || !options.run.reference.empty() || options.run.target_error || options.run.time_limit ||
           options.run.save_every;
}

const std::vector<View>& views() {
    static const std::vector<View> all{{"normals", "VIEW_NORMALS", DisplayTransform::as_is},
                                       {"depth", "VIEW_DEPTH", DisplayTransform::maximum},
                                       {"focus", "VIEW_FOCUS", DisplayTransform::maximum},
                                       {"albedo", "VIEW_ALBEDO", DisplayTransform::exposure},
                                       {"emission", "VIEW_EMISSION", DisplayTransform::exposure},
                                       {"texture-coordinates", "VIEW_TEXTURE_COORDINATES", DisplayTransform::as_is},
                                       {"triangles", "VIEW_TRIANGLES", DisplayTransform::as_is},
                                       {"instances", "VIEW_INSTANCES", DisplayTransform::as_is},
                                       {"bvh-steps", "VIEW_BVH_STEPS", DisplayTransform::maximum, "view.glsl", true},
                                       {"idle-lanes", "", DisplayTransform::as_is, "idle_lanes/path_trace.glsl", true}};
    return all;
}

std::optional<Options> parse_options(const Chapter& chapter, std::span<const Backend> backends,
                                     const std::vector<std::string>& arguments) {
    Options options;
    options.run.backends = backends;
    std::string scene = chapter.default_scene, view;
    CLI::App app(chapter.title, chapter.name);
    app.footer("Exit codes: 0 done, 1 bad input or usage, 2 no usable device, 3 device lost or out of memory.");
    app.set_version_flag("--version", chapter.name + " " LAB_VERSION);
    app.add_option("scene", scene, "Scene file (.json or .obj) or the name of one in assets/scenes")->capture_default_str();
    std::vector<std::string> names{"auto"};
    std::ranges::transform(backends, std::back_inserter(names), &BackendRow::name);
    add_options(app, chapter, options, view, names);
    add_chapter_options(app, chapter, options);
    try {
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 wants the last one first
    } catch (const CLI::CallForHelp&) {
        std::cout << app.help();
        return std::nullopt;
    } catch (const CLI::CallForVersion&) {
        std::cout << app.version() << "\n";
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        std::string message = error.what();
        std::replace(message.begin(), message.end(), '\n', ' ');
        throw UserError(message + " (--help shows all options)");
    }
    if (options.run.window == WindowChoice::always && needs_no_window(options))
        throw UserError(
            "--window does not go with --report, --reference, --target-error, --time-limit or "
            "--save-every: leave one of them out");
    if (options.run.sanitize || options.run.debug_pixel) {
        if (options.run.backend != "auto" && options.run.backend != "native")
            throw UserError("--sanitize and --debug-pixel do not go with --backend " + options.run.backend + ": leave it out");
        options.run.backend = "native";
    }
    if (options.run.debug_pixel) options.run.window = WindowChoice::never;
    options.scene.file = find_scene(scene);
    for (const auto& known : views())
        if (known.name == view) options.image.view = &known;
    if (options.run.outputs.empty()) {
        const std::string stem = chapter.name + (options.image.view ? "_" + options.image.view->name : "");
        options.run.has_default_outputs = true;
        options.run.outputs = {"output/" + stem + ".png", "output/" + stem + ".exr"};
    }
    return options;
}

}  // namespace lab
