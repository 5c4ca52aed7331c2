#include "tracing/tracer.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "error.h"
#include "files/file.h"
#include "files/project_folder.h"
#include "scene/json_object.h"
#include "tracing/vulkan_backends.h"

namespace lab {
namespace {

// These shaders of shaders/ and everything they include, as shader_files() returns them.
std::map<std::filesystem::path, std::filesystem::path> files_of(std::initializer_list<const char*> names,
                                                                const Estimator& estimator) {
    std::map<std::filesystem::path, std::filesystem::path> files;
    for (const char* name : names)
        files.merge(shader_files({.file = project_folder() / "shaders" / name,
                                  .named_includes = named_includes(estimator),
                                  .replacements = estimator.replacements}));
    return files;
}

// The files that a chapter may replace by its own of the same name, which tools and pages in a browser know from this list, too.
const std::vector<std::filesystem::path>& replaceable_files() {
    static const std::vector<std::filesystem::path> files = [] {
        const auto list = project_folder() / "shaders/replaceable.json";
        const auto names = parse_json(list.string(), read_file(list, 1 << 16)).get<std::vector<std::string>>();
        return std::vector<std::filesystem::path>(names.begin(), names.end());
    }();
    return files;
}

// The folder of an estimator's chapter, that of the chapter which this one continues, and so on.
std::vector<std::filesystem::path> continued_folders(const Estimator& estimator) {
    std::vector folders{(estimator.observed.empty() ? estimator.file : estimator.observed).parent_path()};
    for (;;) {
        const auto description = folders.back() / "chapter.json";
        if (!std::filesystem::exists(description)) return folders;
        const auto continued = parse_json(description.string(), read_file(description, 1 << 16)).value("continues", "");
        if (continued.empty()) return folders;
        folders.push_back(project_folder() / "chapters" / continued);
    }
}

}  // namespace

std::map<std::string, std::filesystem::path> named_includes(const Estimator& estimator) {
    std::map<std::string, std::filesystem::path> names{{"path_trace.glsl", estimator.file}};
    const auto is_replaced = [&](const auto& place) {
        return estimator.replacements.contains(std::filesystem::weakly_canonical(place));
    };
    const auto add = [&](const std::string& name, const std::filesystem::path& file, std::vector<std::filesystem::path> places) {
        for (auto& folder : places) folder /= file.filename();
        places.push_back(project_folder() / "shaders" / file);
        const auto is_there = [](const auto& place) { return std::filesystem::exists(place); };
        if (std::ranges::none_of(places, is_there)) return;  // a later chapter is the first that has it
        names[name] = *std::ranges::find_if(places, [&](const auto& place) { return is_there(place) || is_replaced(place); });
    };
    const auto folders = continued_folders(estimator);
    for (const auto& file : replaceable_files()) add(file.filename().string(), file, folders);
    if (!estimator.observed.empty()) {
        names["observed.glsl"] = estimator.observed;
        names["observed_sample_loop.glsl"] = names["sample_loop.glsl"];
        add("sample_loop.glsl", "engine/sample_loop.glsl", {estimator.file.parent_path()});
    }
    return names;
}

std::set<std::filesystem::path> replaceable_places(const Estimator& estimator) {
    std::set<std::filesystem::path> places;
    for (const auto& [name, file] : named_includes(estimator))
        places.insert(std::filesystem::weakly_canonical(estimator.file.parent_path() / name));
    const auto chapters = std::filesystem::weakly_canonical(project_folder() / "chapters");
    for (const auto& [place, file] : files_of({"engine/render_samples.glsl"}, estimator))
        if (*place.lexically_relative(chapters).begin() != "..") places.insert(place);
    return places;
}

ShaderSource shader_source(const std::string& name, const GpuScene& scene, const Estimator& estimator) {
    ShaderSource source{.file = project_folder() / "shaders" / name,
                        .defines = scene.defines(),
                        .named_includes = named_includes(estimator),
                        .replacements = estimator.replacements,
                        .edit = estimator.edit};
    source.defines.insert(source.defines.end(), estimator.defines.begin(), estimator.defines.end());
    return source;
}

std::set<std::filesystem::path> shader_files(const Estimator& estimator) {
    std::set<std::filesystem::path> files;
    for (const auto& [place, file] : files_of({"engine/render.comp", "engine/render.rgen", "engine/add_samples.comp",
                                               "engine/trace_ray/closest_hit.rchit", "engine/trace_ray/miss.rmiss"},
                                              estimator))
        files.insert(file);
    if (named_includes(estimator).contains("filter.glsl"))
        for (const auto& [place, file] : files_of({"engine/filter.comp"}, estimator)) files.insert(file);
    return files;
}

uint64_t estimator_hash(const Estimator& estimator) {
    uint64_t hash = hash_text("");
    for (const auto& define : estimator.defines) hash = hash_text(define + "\n", hash);
    // What render.comp and render.rgen have in common.
    for (const auto& [place, file] :
         files_of({"interface.h", "world/scene.glsl", "world/ray.glsl", "engine/render_samples.glsl"}, estimator))
        hash = hash_text(read_file(file, max_shader_bytes), hash);
    return hash;
}

DeviceTracer::DeviceTracer(const Device& device, std::span<const Binding> bindings) : device_(device) {
    if (std::ranges::find(bindings, BINDING_SAMPLES, &Binding::index) != bindings.end())
        adder_.emplace(device, ShaderSource{.file = project_folder() / "shaders" / "engine/add_samples.comp"}, bindings,
                       sizeof(DispatchParameters));
}

std::optional<double> DeviceTracer::trace(std::span<const DispatchParameters> steps, uint32_t block_count,
                                          uint32_t film_offset) const {
    // A shader that has ended before probably will again: if not soon, then because the machine is busy.
    constexpr double seconds_of_first = 3, seconds_of_later = 20;
    const auto record_steps = [&](const vk::raii::CommandBuffer& commands) {
        for (const DispatchParameters& step : steps) {
            record(commands, step, block_count, film_offset);
            if (!adder_) continue;
            wait_for_writes(commands);
            adder_->record(commands, &step, block_count, film_offset);
            wait_for_writes(commands);
        }
    };
    const double seconds = device_.submit(record_steps, has_ended_ ? seconds_of_later : seconds_of_first);
    has_ended_ = steps.back().target_samples > 0;
    return seconds;
}

}  // namespace lab
