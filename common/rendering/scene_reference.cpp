#include "rendering/scene_reference.h"

#include <algorithm>
#include <cmath>

#include "files/file.h"
#include "files/project_folder.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

// All references of this scene file, sorted by name.
std::vector<Reference> references_of(const fs::path& scene_file) {
    std::vector<fs::path> files;
    std::error_code none;  // no references, no verdict
    for (const auto& entry : fs::directory_iterator(project_folder() / "assets" / "references", none))
        if (entry.path().extension() == ".exr" && entry.path().filename().string().starts_with(scene_file.stem().string()))
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::vector<Reference> references;
    for (const auto& file : files) {
        Reference reference = read_reference(file);
        if (reference.attributes["scene"] == scene_file.filename()) references.push_back(std::move(reference));
    }
    return references;
}

bool are_equal(const Camera& a, const Camera& b) {
    const bool have_same_focus = a.aperture_radius == 0 || a.focus_distance == b.focus_distance;
    return a.position == b.position && a.forward == b.forward && a.right == b.right && a.up == b.up &&
           a.aperture_radius == b.aperture_radius && have_same_focus;
}

// How the image differs from the one that the scene's file describes; empty if it does not.
std::string difference_from_file(const Scene& scene, const RenderParameters& parameters) {
    const RenderParameters of_file = default_parameters(scene, parameters.image_size);
    if (!are_equal(parameters.camera, of_file.camera)) return "the camera has changed";
    if (parameters.background != of_file.background || parameters.probe_rotation != of_file.probe_rotation)
        return "the background is not the scene's";
    if (scene.has_added_lobes) return "the specular lobe is another one";
    if (parameters.only_path_length >= 0) return "the picture shows a single path length";
    return "";
}

}  // namespace

std::variant<Reference, std::string> find_reference(const Scene& scene, const RenderParameters& parameters) {
    std::string lengths;
    bool is_stale = false;
    for (Reference& reference : references_of(scene.file)) {
        if (reference.attributes["scene_hash"] != hexadecimal(scene.hash)) {
            is_stale = true;
            continue;
        }
        const std::string length = reference.attributes["max_path_length"];
        if (length != std::to_string(parameters.max_path_length)) {
            lengths += (lengths.empty() ? "" : " and ") + length;
            continue;
        }
        if (!reference.variance) return "the reference does not say how exact it is";
        const uvec2 size(reference.mean.width, reference.mean.height);
        if (parameters.image_size % size != uvec2(0) || parameters.image_size.x / size.x != parameters.image_size.y / size.y)
            return "the reference has " + size_text(size) + " pixels, the image is no whole number of times larger";
        const std::string difference = difference_from_file(scene, parameters);
        if (!difference.empty()) return difference;
        return std::move(reference);
    }
    if (!lengths.empty()) return "this scene's references are for a maximal path length of " + lengths;
    if (is_stale) return "this scene's reference is older than the scene: ./lab reference --all";
    return "this scene has no reference";
}

std::optional<VerdictSettings> settings_for_verdict(const Scene& scene, const RenderParameters& parameters) {
    if (!difference_from_file(scene, parameters).empty()) return std::nullopt;
    std::optional<VerdictSettings> nearest;
    const auto distance = [&](uint32_t length) {
        return std::abs(static_cast<double>(length) - static_cast<double>(parameters.max_path_length));
    };
    for (const Reference& reference : references_of(scene.file)) {
        if (reference.attributes.at("scene_hash") != hexadecimal(scene.hash) || !reference.variance) continue;
        const auto length = static_cast<uint32_t>(std::stoul(reference.attributes.at("max_path_length")));
        if (nearest && distance(nearest->max_path_length) <= distance(length)) continue;
        const uvec2 size(reference.mean.width, reference.mean.height);
        const double times = std::round(static_cast<double>(parameters.image_size.x) / size.x);
        nearest = {length, size * static_cast<uint32_t>(std::max(times, 1.0))};
    }
    return nearest;
}

std::string mismatch(const Reference& reference, const RenderJob& job) {
    const auto value = [&](const std::string& name, const std::string& otherwise) {
        const auto found = reference.attributes.find(name);
        return found == reference.attributes.end() ? otherwise : found->second;
    };
    const std::string &hash = job.header.scene_hash, length = std::to_string(job.parameters.max_path_length);
    if (value("scene_hash", hash) != hash)
        return "shows " + value("scene", "another scene") + ", the image shows another scene or another version of it";
    const auto or_radiance = [](const std::string& shows) { return shows.empty() ? "radiance" : shows; };
    const std::string reference_shows = value("shows", "");
    if (reference_shows != job.header.shows && job.filter.passes == 0)  // a filtered picture is compared for its bias
        return "shows " + or_radiance(reference_shows) + ", the image shows " + or_radiance(job.header.shows);
    const std::string reference_length = value("max_path_length", length);
    if (reference_length != length)
        return "has paths of at most " + reference_length + " bounces, the image has paths of at most " + length +
               ": use --max-path-length " + reference_length;
    return "";
}

}  // namespace lab
