#include "scene/scene_file.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "error.h"
#include "scene/json_object.h"

namespace lab {
namespace {

constexpr uint64_t max_json_bytes = uint64_t{16} << 20;

glm::dmat4 read_rotation(const JsonObject& rotation) {
    const glm::dvec3 axis(rotation.required("axis", rotation.vector("axis")));
    const double degrees = rotation.required("degrees", rotation.number("degrees"));
    if (axis == glm::dvec3(0)) rotation.fail("axis", "must not be zero");
    return glm::rotate(glm::dmat4(1), glm::radians(degrees), axis);
}

void read_box(const JsonObject& entry, Medium& medium) {
    const nlohmann::json& corners = entry.array("box");
    const auto fail = [&] { entry.fail("box", "must be two corners of three numbers, the lower one first"); };
    if (corners.size() != 2) fail();
    for (int i = 0; i < 2; ++i) {
        const nlohmann::json& corner = corners[static_cast<size_t>(i)];
        if (!corner.is_array() || corner.size() != 3) fail();
        for (int axis = 0; axis < 3; ++axis) {
            const nlohmann::json& number = corner[static_cast<size_t>(axis)];
            if (!number.is_number() || !(std::abs(number.get<double>()) <= 1e9)) fail();
            (i == 0 ? medium.low : medium.high)[axis] = number.get<float>();
        }
    }
    if (!glm::all(glm::lessThan(medium.low, medium.high))) fail();
}

// The keys of "fog". A "medium" has one more.
MediumDescription read_medium(const JsonObject& entry, const std::filesystem::path& folder) {
    Medium medium{};
    const double extinction = entry.required("extinction", entry.number("extinction"));
    if (!(extinction >= 0 && extinction <= 1e9)) entry.fail("extinction", "must be from 0 to 1e9 per unit of length");
    medium.extinction = static_cast<float>(extinction);
    medium.albedo = entry.required("albedo", entry.number_or_vector("albedo"));
    if (glm::any(glm::lessThan(medium.albedo, vec3(0))) || glm::any(glm::greaterThan(medium.albedo, vec3(1))))
        entry.fail("albedo", "must be from 0 to 1");
    const double anisotropy = entry.number("anisotropy").value_or(0);
    // Closer to 1, 32-bit numbers do not resolve the lobe.
    if (!(std::abs(anisotropy) <= 0.999)) entry.fail("anisotropy", "must be from -0.999 to 0.999");
    medium.anisotropy = static_cast<float>(anisotropy);
    const auto density = entry.text("density");
    if (density) read_box(entry, medium);
    if (!density && entry.has("box")) entry.fail("box", "needs a \"density\"");
    return {medium, density ? folder / to_path(*density) : ""};
}

// Scale acts on points first, so it is the last factor.
MeshPlacement read_placement(const JsonObject& entry, const std::filesystem::path& folder) {
    MeshPlacement placement;
    placement.file = folder / to_path(entry.required("file", entry.text("file")));
    if (const auto materials = entry.text("materials")) placement.materials = folder / to_path(*materials);
    if (entry.has("medium")) {
        const JsonObject medium = entry.object("medium", {"extinction", "albedo", "anisotropy", "density", "box", "boundary"});
        placement.medium = read_medium(medium, folder);
        if (const auto boundary = medium.text("boundary")) {
            if (*boundary != "open") medium.fail("boundary", "can only be \"open\": leave it out where there is a surface");
            placement.is_open = true;
        }
    }
    glm::dmat4 matrix(1);
    if (const auto translation = entry.vector("translation")) matrix = glm::translate(matrix, glm::dvec3(*translation));
    if (entry.has("rotation")) matrix = matrix * read_rotation(entry.object("rotation", {"axis", "degrees"}));
    if (const auto scale = entry.number_or_vector("scale")) {
        if (scale->x == 0 || scale->y == 0 || scale->z == 0) entry.fail("scale", "must not be zero");
        matrix = glm::scale(matrix, glm::dvec3(*scale));
    }
    placement.object_to_world = glm::dmat4x3(matrix);
    return placement;
}

CameraPose read_camera(const JsonObject& camera) {
    CameraPose pose;
    pose.position = camera.required("position", camera.vector("position"));
    pose.target = camera.required("target", camera.vector("target"));
    if (pose.position == pose.target) camera.fail("target", "must differ from \"position\"");
    pose.up = camera.vector("up").value_or(pose.up);
    const double vertical_fov = camera.number("vertical_fov").value_or(pose.vertical_fov);
    if (!(vertical_fov > 0 && vertical_fov < 180)) camera.fail("vertical_fov", "must be above 0 and below 180 degrees");
    pose.vertical_fov = static_cast<float>(vertical_fov);
    pose.aperture_diameter = static_cast<float>(camera.number("aperture_diameter").value_or(0));
    if (!(pose.aperture_diameter >= 0 && pose.aperture_diameter <= 1e18f))
        camera.fail("aperture_diameter", "must be from 0 to 1e18");
    constexpr auto rule_of_focus = "must be a number above 0 (1e18 is infinity)";
    if (const auto focus = camera.number("focus_distance", rule_of_focus)) {
        pose.focus_distance = static_cast<float>(*focus);
        if (!(pose.focus_distance > 0)) camera.fail("focus_distance", rule_of_focus);
    }
    return pose;
}

vec3 read_radiance_value(const JsonObject& background, const char* key, const vec3& absent) {
    const vec3 value = background.number_or_vector(key).value_or(absent);
    if (glm::any(glm::lessThan(value, vec3(0)))) background.fail(key, "must not be negative");
    return value;
}

void read_background(const JsonObject& background, const std::filesystem::path& folder, SceneDescription& result) {
    if (background.has("radiance") == background.has("light_probe"))
        background.fail("radiance", "or \"light_probe\" must be given, and not both");
    if (background.has("radiance")) {
        for (const char* key : {"intensity", "rotation_degrees"})
            if (background.has(key)) background.fail(key, "needs a \"light_probe\"");
        result.scene.background = read_radiance_value(background, "radiance", vec3(0));
    } else {
        result.light_probe = folder / to_path(background.required("light_probe", background.text("light_probe")));
        result.scene.background = read_radiance_value(background, "intensity", vec3(1));
        const double degrees = background.number("rotation_degrees").value_or(0);
        result.scene.probe_rotation = static_cast<float>(glm::radians(std::fmod(degrees, 360.0)));
    }
}

}  // namespace

SceneDescription read_scene_file(const std::filesystem::path& file, SourceFiles& files) {
    const std::string name = file.string();
    const std::filesystem::path folder = file.parent_path();
    const nlohmann::json content = parse_json(name, files.read(file, max_json_bytes));
    const JsonObject root(content, name, "the scene",
                          {"description", "meshes", "camera", "background", "fog", "specular", "multiple_scattering", "width",
                           "height", "samples", "max_path_length"});
    SceneDescription result;
    result.scene.description = root.text("description").value_or("");
    for (const nlohmann::json& entry : root.array("meshes"))
        result.meshes.push_back(read_placement(
            {entry, name, "an entry of \"meshes\"", {"file", "materials", "medium", "scale", "rotation", "translation"}},
            folder));
    result.has_camera = root.has("camera");
    if (result.has_camera)
        result.scene.camera = read_camera(
            root.object("camera", {"position", "target", "up", "vertical_fov", "aperture_diameter", "focus_distance"}));
    if (root.has("background"))
        read_background(root.object("background", {"radiance", "light_probe", "intensity", "rotation_degrees"}), folder, result);
    if (root.has("fog"))
        result.fog = read_medium(root.object("fog", {"extinction", "albedo", "anisotropy", "density", "box"}), folder);
    result.scene.multiple_scattering = root.boolean("multiple_scattering").value_or(false);
    result.specular = root.boolean("specular").value_or(false);

    constexpr uint32_t max_count = 1'000'000'000;
    RenderDefaults& defaults = result.scene.defaults;
    defaults.width = root.integer("width", 1, max_image_extent).value_or(defaults.width);
    defaults.height = root.integer("height", 1, max_image_extent).value_or(defaults.height);
    defaults.samples = root.integer("samples", 1, max_count).value_or(defaults.samples);
    defaults.max_path_length = root.integer("max_path_length", 0, path_length_limit).value_or(defaults.max_path_length);
    defaults.limits_paths = root.has("max_path_length");
    return result;
}

}  // namespace lab
