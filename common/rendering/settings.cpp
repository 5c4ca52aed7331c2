#include "rendering/settings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "error.h"
#include "files/file.h"
#include "files/project_folder.h"
#include "rendering/numbers_text.h"
#include "scene/material_keywords.h"

namespace lab {
namespace {

uint32_t max_path_length(const Chapter& chapter, const Scene& scene, const Options& options) {
    const uint32_t only = options.light.only_path_length.value_or(0);
    if (options.light.max_path_length && only > *options.light.max_path_length)
        throw UserError("--only-path-length " + std::to_string(only) + " is above --max-path-length " +
                        std::to_string(*options.light.max_path_length) + ": the picture would be black");
    if (ends_at_safety_limit(chapter, scene, options)) return safety_limit;
    return std::max(options.light.max_path_length.value_or(scene.defaults.max_path_length), only);
}

uvec2 image_size_of(const Scene& scene, const Options& options) {
    return {options.image.width.value_or(scene.defaults.width), options.image.height.value_or(scene.defaults.height)};
}

// The value of the chapter's option number i: as given, or its default.
double value_of(const Chapter& chapter, size_t i, const Options& options) {
    return options.samples.chapter_values[i].value_or(chapter.options[i].default_value);
}

// An upper bound on the albedo of all materials, in any direction. Microfacets reflect nearly everything at grazing angles.
double largest_albedo(const Scene& scene) {
    float largest = 0;
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        const bool has_microfacets = !scene.microfacets.empty() && scene.microfacets[i].roughness > 0;
        const vec3 albedo = material.refractive_index > 0 || has_microfacets ? vec3(1) : albedo_of(material);
        largest = std::max({largest, albedo.r, albedo.g, albedo.b});
    }
    for (const Medium& medium : scene.media)
        if (medium.extinction > 0) largest = std::max({largest, medium.albedo.r, medium.albedo.g, medium.albedo.b});
    return largest;
}

// Throws UserError if the chapter would not read one of the shaders that --shader names.
void check_replacements(const Estimator& chapter, const Replacements& replacements) {
    if (replacements.empty()) return;
    std::set<std::filesystem::path> places = replaceable_places(chapter);
    Estimator replaced = chapter;
    replaced.replacements = replacements;
    places.merge(replaceable_places(replaced));
    const auto chapters = std::filesystem::weakly_canonical(project_folder() / "chapters");
    for (const auto& [wanted, file] : replacements) {
        if (places.contains(wanted)) continue;
        std::string names;
        for (const auto& place : places) {
            const bool is_own = place.parent_path() == std::filesystem::weakly_canonical(chapter.file).parent_path();
            names +=
                (names.empty() ? "" : ", ") + (is_own ? place.filename() : place.lexically_relative(chapters)).generic_string();
        }
        throw UserError("--shader: the chapter does not read " + in_quotes(wanted.lexically_relative(chapters).generic_string()) +
                        ": write NAME=FILE, where NAME is one of " + names);
    }
}

}  // namespace

CameraPose camera_of(const Chapter& chapter, const Scene& scene, const Options& options) {
    const CameraOptions& wanted = options.camera;
    vec3 position = scene.camera.position;
    const uvec2 size = image_size_of(scene, options);
    if (scene.is_framed && size.x < size.y) {  // what fits between top and bottom also has to fit between left and right
        const double half = glm::radians(0.5 * scene.camera.vertical_fov), tangent = std::tan(half) * size.x / size.y;
        const double farther = std::sin(half) / std::sin(std::atan(tangent));
        position = scene.camera.target + static_cast<float>(farther) * (position - scene.camera.target);
    }
    return {.position = wanted.position.value_or(position),
            .target = wanted.target.value_or(scene.camera.target),
            .up = wanted.up.value_or(scene.camera.up),
            .vertical_fov = wanted.vertical_fov.value_or(scene.camera.vertical_fov),
            .aperture_diameter = chapter.handles.lens ? wanted.aperture_diameter.value_or(scene.camera.aperture_diameter) : 0,
            .focus_distance = wanted.focus_distance.value_or(scene.camera.focus_distance)};
}

vec3 background_of(const Scene& scene, const Options& options) { return options.light.background.value_or(scene.background); }

size_t value_of(const ChapterChoice& choice, const Options& options) {
    const auto given = options.estimator.choices.find(choice.name);
    return given == options.estimator.choices.end() ? 0 : given->second;
}

FilterChoice filter_of(const Chapter& chapter, const Options& options) {
    if (options.image.view) return {};
    for (const ChapterChoice& choice : chapter.choices)
        if (const size_t value = value_of(choice, options); choice.is_filter() && value > 0)
            return {choice.values[value].first, choice.define() + ' ' + choice.values[value].second, choice.passes[value]};
    return {};
}

std::string shown_instead(const Chapter& chapter, const Scene& scene, const Options& options) {
    if (options.image.view) return "the view " + options.image.view->name;
    for (const ChapterChoice& choice : chapter.choices) {
        const size_t value = value_of(choice, options), materials = scene.material_names.size();
        if (value == 0 || choice.shows.empty()) continue;
        if (!choice.chooses_material || value > materials) return choice.shows;
        return choice.shows + " (material " + std::to_string(value) + " of " + std::to_string(materials) + ": " +
               in_quotes(scene.material_names[value - 1]) + ")";
    }
    return {};
}

Strategy strategy_of(const Chapter& chapter, const Options& options) {
    if (chapter.strategies.empty()) return Strategy::bounces;
    return options.estimator.strategy.value_or(chapter.strategies.front());
}

bool asks_for_sky(const Options& options) { return options.light.background.value_or(vec3(0)) != vec3(0); }

bool asks_for_lens(const Options& options) { return options.camera.aperture_diameter.value_or(0) > 0; }

bool ends_at_safety_limit(const Chapter& chapter, const Scene& scene, const Options& options) {
    return chapter.unlimited_path_length && !options.light.max_path_length && !scene.defaults.limits_paths &&
           options.light.only_path_length.value_or(0) <= safety_limit;
}

RenderParameters make_parameters(const Chapter& chapter, const Scene& scene, const Options& options) {
    RenderParameters parameters = default_parameters(scene, camera_of(chapter, scene, options), image_size_of(scene, options));
    parameters.background = background_of(scene, options);
    parameters.seed_key = seed_key(options.samples.seed);
    parameters.first_sample = options.samples.first_sample;
    parameters.max_path_length = max_path_length(chapter, scene, options);
    if (options.light.only_path_length) parameters.only_path_length = static_cast<int>(*options.light.only_path_length);
    for (size_t i = 0; i < chapter.options.size(); ++i)
        std::visit(
            [&](auto member) {
                using Number = std::remove_reference_t<decltype(parameters.*member)>;
                parameters.*member = static_cast<Number>(value_of(chapter, i, options));
            },
            chapter.options[i].parameter);
    if (!options.image.view) parameters.splat_unit = splat_unit_of(scene, strategy_of(chapter, options), chapter.handles);
    return parameters;
}

std::string camera_flags(const CameraPose& pose, char separator) {
    std::string lens;
    if (pose.aperture_diameter > 0) {
        lens = std::string(" --aperture-diameter") + separator + exact_text(pose.aperture_diameter);
        if (pose.focus_distance > 0) lens += std::string(" --focus-distance") + separator + exact_text(pose.focus_distance);
    }
    return "--camera-position" + (separator + exact_text(pose.position)) + " --camera-target" + separator +
           exact_text(pose.target) + " --camera-up" + separator + exact_text(pose.up) + " --vertical-fov" + separator +
           exact_text(pose.vertical_fov) + lens;
}

std::string settings_text(const Chapter& chapter, const RenderParameters& parameters, const Scene& scene,
                          const Options& options) {
    std::ostringstream text;
    text.precision(9);
    text << "--max-path-length " << parameters.max_path_length;
    if (parameters.only_path_length >= 0) text << " --only-path-length " << parameters.only_path_length;
    for (size_t i = 0; i < chapter.options.size(); ++i)
        text << ' ' << chapter.options[i].name << ' ' << value_of(chapter, i, options);
    const Strategy strategy = strategy_of(chapter, options);
    if (!chapter.strategies.empty() && strategy != chapter.strategies.front()) text << " --strategy " << to_string(strategy);
    for (const ChapterChoice& choice : chapter.choices)
        if (const size_t value = value_of(choice, options); value > 0 && !choice.is_filter())
            text << ' ' << choice.name << ' ' << choice.values[value].first;
    if (options.image.view) text << " --view " << options.image.view->name;
    if (options.scene.specular) text << " --specular";
    text << ' ' << camera_flags(camera_of(chapter, scene, options), ' ') << " --background "
         << exact_text(background_of(scene, options));
    return text.str();
}

Estimator estimator_of(const Chapter& chapter) { return {project_folder() / "chapters" / chapter.name / "path_trace.glsl"}; }

Estimator observed_by(const std::string& file, Estimator estimator) {
    estimator.observed = std::move(estimator.file);
    estimator.file = project_folder() / "shaders" / "observation" / file;
    return estimator;
}

Estimator make_estimator(const Chapter& chapter, const Options& options) {
    Estimator estimator = estimator_of(chapter);
    check_replacements(estimator, options.estimator.shaders);
    estimator.replacements = options.estimator.shaders;
    if (const auto& pixel = options.run.debug_pixel)
        estimator.defines.push_back("ONLY_PIXEL uvec2(" + std::to_string(pixel->x) + "u, " + std::to_string(pixel->y) + "u)");
    if (asks_for_lens(options)) estimator.defines.emplace_back("FEATURE_LENS");
    if (const auto& view = options.image.view) {
        if (!view->define.empty()) estimator.defines.push_back(view->define);
        return observed_by(view->observer, std::move(estimator));
    }
    if (strategy_of(chapter, options) == Strategy::light) estimator.defines.emplace_back("STRATEGY STRATEGY_LIGHT");
    for (const ChapterChoice& choice : chapter.choices)
        if (const size_t value = value_of(choice, options); value > 0 && !choice.is_filter())
            estimator.defines.push_back(choice.define() + ' ' + choice.values[value].second);
    if (asks_for_sky(options)) estimator.defines.emplace_back("FEATURE_SKY");
    estimator.max_threads_per_pixel = options.estimator.max_threads_per_pixel.value_or(estimator.max_threads_per_pixel);
    return estimator;
}

std::string safety_limit_text(const Scene& scene) {
    const double albedo = largest_albedo(scene);
    char text[160];
    if (albedo < 1)
        std::snprintf(text, sizeof text, "up to %u bounces; all light of more is below %.0e of the brightest emission",
                      safety_limit, std::max(std::pow(albedo, safety_limit + 1) / (1 - albedo), 1e-300));
    else
        std::snprintf(text, sizeof text,
                      "up to %u bounces; a surface or medium may scatter all light, so light of more may be missing",
                      safety_limit);
    return text;
}

}  // namespace lab
