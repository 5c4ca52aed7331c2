// A scene as plain arrays, ready to be copied to a device.
#pragma once
#include <filesystem>
#include <limits>
#include <optional>
#include <ranges>
#include <string>
#include <vector>

#include "image/image.h"
#include "shaders/interface.h"

namespace lab {

// The triangles of a mesh file, a range of the scene's triangles in object space. Dielectric ones come last, so that each
// material class is a range, too.
struct Mesh {
    std::string file;
    uint32_t first_triangle = 0;
    uint32_t triangle_count = 0;
    uint32_t dielectric_count = 0;
    bool is_open = false;  // it is no surface: only a medium ends there

    // Indices of all its triangles.
    auto triangles() const { return std::views::iota(first_triangle, first_triangle + triangle_count); }
};

// The triangles of one material class in a mesh.
struct MaterialClassRange {
    uint32_t material_class;
    uint32_t first_triangle;
    uint32_t triangle_count;
};
std::vector<MaterialClassRange> material_class_ranges(const Mesh& mesh);  // diffuse before dielectric; none is empty

// Longest path length that a scene or flag may request, so that samples end in bounded time.
inline constexpr uint32_t path_length_limit = 1000000;

// Most triangles in a mesh file, and in all instances together for the tree of `compute`.
inline constexpr size_t max_triangle_count = (size_t{1} << 28) - 1;

// Defaults for what neither a flag nor the scene specifies.
struct RenderDefaults {
    uint32_t width = 512;
    uint32_t height = 512;
    uint32_t samples = 64;
    uint32_t max_path_length = 8;
    bool limits_paths = false;  // whether the scene itself asks for this length
};

struct CameraPose {
    vec3 position{0, 0, 1};
    vec3 target{0, 0, 0};
    vec3 up{0, 1, 0};
    float vertical_fov = 45;      // degrees, in (0,180)
    float aperture_diameter = 0;  // of a thin lens, scene units; 0 is a pinhole
    float focus_distance = 0;     // of the plane in focus, along the viewing direction; 0 is the distance to the target
};

struct Scene {
    std::filesystem::path file;
    std::string description;

    std::vector<vec3> positions;            // object space
    std::vector<vec3> normals;              // unit length, per position; empty if no mesh has vertex normals
    std::vector<vec2> texture_coordinates;  // per position, v down from the top row; empty without textures
    std::vector<uvec3> triangles;           // indices of positions, counter-clockwise seen from the front
    std::vector<uint32_t> triangle_materials;
    std::vector<Material> materials;
    std::vector<std::string> material_names;  // per material, as its file says; empty for faces without a material
    std::vector<Microfacets> microfacets;     // per material; empty if none has any
    bool multiple_scattering = false;         // whether to add light that microfacets reflect several times
    std::vector<uvec2> double_sided;  // pairs of opaque triangles in one place that face opposite ways; the second has the
                                      // corners of the first in reverse, starting from the same one
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<uint32_t> instance_meshes;  // per instance
    std::vector<Medium> media;              // the first lies outside of all bodies; empty if there is none but vacuum
    std::vector<float> densities;           // of all media that have a grid
    std::vector<Boundary> boundaries;       // of bodies; the first is none. Empty if no medium ends anywhere
    std::vector<uint32_t> boundary_places;  // the index of a boundary: the sum of one entry per triangle and one per instance
    std::vector<uint32_t> overlaps;         // media of bodies that overlap with others, which the boundaries of these know
    std::vector<Texture> textures;

    CameraPose camera;
    bool is_framed = false;            // the camera is framing_pose()
    vec3 background{0};                // radiance of a constant sky, or factor of the light probe
    std::optional<Image> light_probe;  // equirectangular, +Y up, image centre towards -Z
    float probe_rotation = 0;          // radians
    RenderDefaults defaults;
    bool has_added_lobes = false;  // Phong lobes come from --specular, not from the file

    std::vector<std::string> warnings;           // for the user, one line each
    std::vector<std::filesystem::path> sources;  // all files that the scene was read from
    uint64_t hash = 0;                           // FNV-1a of them

    const Mesh& mesh_of(uint32_t instance) const { return meshes[instance_meshes[instance]]; }
    const Material& material_of(uint32_t triangle) const { return materials[triangle_materials[triangle]]; }
    const vec3& corner(uint32_t triangle, int i) const { return positions[triangles[triangle][i]]; }
};

// Number of triangles in all instances together; cannot overflow.
uint64_t instanced_triangle_count(const Scene& scene);

// Axis-aligned bounding box.
struct Bounds {
    vec3 low{std::numeric_limits<float>::infinity()};
    vec3 high{-std::numeric_limits<float>::infinity()};
    void grow(const vec3& point) { low = glm::min(low, point), high = glm::max(high, point); }
};
// World-space bounds of all instances, tight unless a mesh is rotated. Without instances, low > high.
Bounds world_bounds(const Scene& scene);

// A corner of a triangle of an instance, and the triangle's area, in world space.
glm::dvec3 world_corner(const Scene& scene, uint32_t instance, uint32_t triangle, int i);

// The distance off a triangle at which rays start, unless it is slender: get_error_bound() in shaders/world/shading_data.glsl.
// The magnitude is that of its coordinates.
double start_distance(const glm::dvec3& magnitude);
double world_area(const Scene& scene, uint32_t instance, uint32_t triangle);

// Reads a .json scene or a bare .obj. `specular` enables Phong lobes, like the key in the scene. The default camera is
// framing_pose(); a bare .obj without lights gets a white sky. Throws UserError.
Scene load_scene(const std::filesystem::path& file, bool specular = false);

// A pose that sees everything inside the bounds, from +Z and slightly above, for images at least as wide as high.
CameraPose framing_pose(const Bounds& bounds);

// The camera for a pose and an image size in pixels. An `up` along the line of sight is replaced. Throws UserError if the pose
// has no direction or `up`, or a field of view outside (0,180) degrees.
Camera make_camera(const CameraPose& pose, uint32_t width, uint32_t height);

}  // namespace lab
