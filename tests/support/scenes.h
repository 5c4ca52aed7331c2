// Small scenes built in memory.
#pragma once
#include <filesystem>
#include <vector>

#include "scene/scene.h"

namespace lab {

// A Lambertian material whose front emits.
Material diffuse_material(const vec3& albedo, const vec3& emission = vec3(0));

// The same everywhere.
Medium homogeneous_medium(float extinction, const vec3& albedo, float anisotropy = 0);

// Fills an instance with a medium, behind its glass or with no surface at all. Other glass is clear.
void fill(Scene& scene, const Medium& medium, bool is_glass = false, uint32_t instance = 0);

// A parallelogram. Its front is the side that edge_u × edge_v points to.
struct Quad {
    vec3 corner;
    vec3 edge_u;
    vec3 edge_v;
    uint32_t material = 0;
};

// A scene of one mesh and one instance. The four positions of a quad are consecutive: corner, + edge_u, + both, + edge_v.
// Dielectric quads must come last.
Scene make_scene(const std::vector<Material>& materials, const std::vector<Quad>& quads);

enum class Facing { inwards, outwards };
std::vector<Quad> box_sides(const vec3& low, const vec3& high, uint32_t material, Facing facing);

// The sides of the box [-1,1]³, with their fronts inside. The camera is inside, too.
Scene closed_box(const Material& material);

// An icosahedron around the origin, each triangle divided into four: 80 triangles of circumscribed radius 1. Facing inwards it
// encloses the camera, outwards it fills the camera's view.
Scene make_sphere(const Material& material, Facing facing);

// Lamps in the box [-1,1]³ with edges of up to `size`, turned all ways, whose radiance spans so many decades. The others are
// grey.
Scene random_lamps(int count, double decades, float size = 0.05f, const std::vector<Quad>& others = {});

// Turns all materials into rough metal of the same colours with this Pr.
void make_metal(Scene& scene, float roughness);

struct TriangleMesh {
    std::vector<vec3> positions;
    std::vector<uvec3> triangles;
};

// A closed, bumpy sphere of about unit radius with 2 * rings * (rings - 1) triangles.
TriangleMesh bumpy_sphere(uint32_t rings);

// A scene with that mesh under a white sky, seen from +Z, without an instance; the mesh may be empty.
Scene lit_scene(const TriangleMesh& mesh);

// Adds an instance of the scene's first mesh, or makes it the only one.
void place(Scene& scene, const mat4x3& object_to_world);
void set_transform(Scene& scene, const mat4x3& object_to_world);

// Files and folders in a folder, sorted by name.
std::vector<std::filesystem::path> sorted_entries(const std::filesystem::path& folder);

}  // namespace lab
