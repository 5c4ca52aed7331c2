#include "scene/scene.h"

#include <cmath>
#include <map>
#include <tuple>

#include "error.h"
#include "image/image_checks.h"
#include "scene/bodies.h"
#include "scene/contacts.h"
#include "scene/features.h"
#include "scene/lamp_warnings.h"
#include "scene/media.h"
#include "scene/obj_file.h"
#include "scene/scene_file.h"
#include "scene/warnings.h"

namespace lab {
namespace {

Instance make_instance(const MeshPlacement& placement) {
    Instance instance;
    instance.object_to_world = mat4x3(placement.object_to_world);
    instance.normal_to_world = mat3(glm::inverse(glm::transpose(glm::dmat3(placement.object_to_world))));
    for (int column = 0; column < 3; ++column)
        if (glm::any(glm::isinf(instance.normal_to_world[column])) || glm::any(glm::isnan(instance.normal_to_world[column])))
            throw UserError("the scale of " + placement.file.string() + " is too small or too large");
    return instance;
}

// Reads each mesh once with each of its materials, and places its instances.
void load_meshes(const SceneDescription& description, bool specular, SourceFiles& sources, Scene& scene) {
    std::map<std::tuple<std::filesystem::path, std::filesystem::path, bool>, uint32_t> mesh_of_files;
    std::vector<ObjFile> files;
    for (const MeshPlacement& placement : description.meshes) {
        const auto [mesh, is_new] = mesh_of_files.try_emplace(
            {placement.file.lexically_normal(), placement.materials.lexically_normal(), placement.is_open},
            static_cast<uint32_t>(files.size()));
        if (is_new) files.push_back(read_obj(placement.file, placement.materials, sources, scene.warnings));
        scene.instance_meshes.push_back(mesh->second);
    }
    assemble_meshes(files, specular, sources, scene);
    for (const auto& [key, mesh] : mesh_of_files) scene.meshes[mesh].is_open = std::get<bool>(key);
    for (const MeshPlacement& placement : description.meshes) scene.instances.push_back(make_instance(placement));
}

}  // namespace

std::vector<MaterialClassRange> material_class_ranges(const Mesh& mesh) {
    const uint32_t diffuse_count = mesh.triangle_count - mesh.dielectric_count;
    std::vector<MaterialClassRange> ranges;
    if (diffuse_count > 0) ranges.push_back({MATERIAL_CLASS_DIFFUSE, mesh.first_triangle, diffuse_count});
    if (mesh.dielectric_count > 0)
        ranges.push_back({MATERIAL_CLASS_DIELECTRIC, mesh.first_triangle + diffuse_count, mesh.dielectric_count});
    return ranges;
}

uint64_t instanced_triangle_count(const Scene& scene) {
    uint64_t count = 0;
    for (const uint32_t mesh : scene.instance_meshes) count += scene.meshes[mesh].triangle_count;
    return count;
}

Bounds world_bounds(const Scene& scene) {
    std::vector<Bounds> mesh_bounds(scene.meshes.size());
    for (size_t i = 0; i < scene.meshes.size(); ++i)
        for (const uint32_t triangle : scene.meshes[i].triangles())
            for (int corner = 0; corner < 3; ++corner) mesh_bounds[i].grow(scene.corner(triangle, corner));
    Bounds world;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Bounds& box = mesh_bounds[scene.instance_meshes[i]];
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 point(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                   corner & 4 ? box.high.z : box.low.z);
            world.grow(vec3(glm::dmat4x3(scene.instances[i].object_to_world) * glm::dvec4(point, 1)));
        }
    }
    return world;
}

double start_distance(const glm::dvec3& magnitude) { return 8 * 0x1p-24 * (magnitude.x + magnitude.y + magnitude.z); }

glm::dvec3 world_corner(const Scene& scene, uint32_t instance, uint32_t triangle, int i) {
    return glm::dmat4x3(scene.instances[instance].object_to_world) * glm::dvec4(scene.corner(triangle, i), 1);
}

double world_area(const Scene& scene, uint32_t instance, uint32_t triangle) {
    // Without the translation, which would only add rounding errors.
    const glm::dmat3 linear{mat3(scene.instances[instance].object_to_world)};
    const glm::dvec3 origin(scene.corner(triangle, 0));
    const auto side = [&](int i) { return linear * (glm::dvec3(scene.corner(triangle, i)) - origin); };
    return 0.5 * glm::length(glm::cross(side(1), side(2)));
}

Scene load_scene(const std::filesystem::path& file, bool specular) {
    const std::string name = file.string();
    const std::string extension = lower_case_extension(file);
    if (extension != ".json" && extension != ".obj") throw UserError(name + ": a scene must be a .json or .obj file");
    const bool is_bare_mesh = extension == ".obj";

    SourceFiles sources;
    SceneDescription description;
    if (is_bare_mesh)
        description.meshes.emplace_back().file = file;
    else
        description = read_scene_file(file, sources);

    Scene& scene = description.scene;
    scene.file = file;
    // Errors in files also name the scene that refers to them.
    const auto load = [&](const auto& load_part) {
        try {
            load_part();
        } catch (const UserError& error) {
            throw is_bare_mesh ? error : UserError(name + ": " + error.what());
        }
    };
    load([&] { load_meshes(description, specular || description.specular, sources, scene); });
    std::vector<Body> bodies = find_bodies(scene);
    std::vector<bool> has_medium;
    for (const MeshPlacement& placement : description.meshes) has_medium.push_back(placement.medium.has_value());
    turn_inside_out_glass(scene, bodies, has_medium);
    separate_contacts(scene, bodies);
    load([&] { add_media(description, bodies, sources, scene); });
    scene.has_added_lobes = specular && !description.specular && features_of(scene).specular();

    if (!description.light_probe.empty()) {
        load([&] { scene.light_probe = read_radiance(description.light_probe, scene.warnings); });
        sources.read(description.light_probe, max_image_file_bytes);  // for the hash
    }
    if (description.fog && description.fog->density.empty() && description.fog->medium.extinction > 0 &&
        (scene.background != vec3(0) || !description.light_probe.empty()))
        scene.warnings.push_back(name +
                                 ": its \"fog\" has no end and hides the sky: to see it, fill a mesh with an open boundary");
    if (is_bare_mesh && !features_of(scene).area_lights) {
        scene.background = vec3(1);
        scene.warnings.push_back(name + ": nothing in it emits light: the sky is white, of radiance 1");
    }

    const Bounds bounds = world_bounds(scene);
    const double diagonal = scene.instances.empty() ? 0 : glm::distance(glm::dvec3(bounds.low), glm::dvec3(bounds.high));
    if (!(diagonal < 1.8e19)) throw UserError(name + ": its coordinates are too large for 32-bit numbers");
    if (diagonal > 0 && diagonal < 1e-18)
        throw UserError(
            name + ": it is smaller than 1e-18 units, so that squares of its lengths vanish in 32 bits: give it a larger scale");
    scene.is_framed = !description.has_camera && !scene.instances.empty();
    if (scene.is_framed) scene.camera = framing_pose(bounds);
    for (auto& warnings : {dielectric_warnings(scene, bodies), precision_warnings(scene), lamp_warnings(scene)})
        scene.warnings.insert(scene.warnings.end(), warnings.begin(), warnings.end());
    scene.hash = sources.hash();
    scene.sources = sources.names();
    return std::move(scene);
}

using glm::dvec3;

CameraPose framing_pose(const Bounds& bounds) {
    const dvec3 low(bounds.low), high(bounds.high);
    const dvec3 centre = 0.5 * (low + high);
    // The bounding sphere touches the top and bottom of the image.
    CameraPose pose;
    const double radius = 0.5 * glm::distance(low, high);
    const double distance = radius / std::sin(glm::radians(0.5 * pose.vertical_fov));
    pose.position = vec3(centre + distance * glm::normalize(dvec3(0, 0.25, 1)));
    pose.target = vec3(centre);
    return pose;
}

Camera make_camera(const CameraPose& pose, uint32_t width, uint32_t height) {
    const dvec3 direction = dvec3(pose.target) - dvec3(pose.position);
    const double distance = glm::length(direction);
    if (!(distance > 0) || !std::isfinite(distance)) throw UserError("camera: position and target must be finite and differ");
    if (!(pose.vertical_fov > 0 && pose.vertical_fov < 180))
        throw UserError("camera: the vertical field of view must be above 0 and below 180 degrees");
    const dvec3 forward = direction / distance;

    // Looking along `up` leaves the camera's roll undefined: then -Z (or +Y) is up in the image.
    dvec3 up(pose.up);
    const double up_length = glm::length(up);
    if (!(up_length > 0) || !std::isfinite(up_length)) throw UserError("camera: up must be finite and not zero");
    if (glm::length(glm::cross(forward, up)) <= 1e-6 * up_length)
        up = std::abs(forward.y) > 0.5 ? dvec3(0, 0, -1) : dvec3(0, 1, 0);
    const dvec3 right = glm::normalize(glm::cross(forward, up));

    const double tangent = std::tan(glm::radians(0.5 * pose.vertical_fov));
    Camera camera;
    camera.position = pose.position;
    camera.forward = vec3(forward);
    camera.right = vec3(tangent * width / height * right);
    camera.up = vec3(tangent * glm::cross(right, forward));
    camera.aperture_radius = 0.5f * pose.aperture_diameter;
    // From here on a plane in focus is at infinity for the shader, which squares lengths in 32 bits.
    const double farthest = 1e18 / glm::length(camera.forward + camera.right + camera.up);
    camera.focus_distance =
        static_cast<float>(std::min(pose.focus_distance > 0 ? double{pose.focus_distance} : distance, farthest));
    return camera;
}

}  // namespace lab
