// Small scenes made in memory.
#pragma once
#include <vector>

#include "scene/scene.h"

namespace lab {

// A Lambertian material. The emission is that of its front.
Material diffuse_material(const vec3& albedo, const vec3& emission = vec3(0));

// A parallelogram. Its front is the side that edge_u × edge_v points to.
struct Quad {
    vec3 corner;
    vec3 edge_u;
    vec3 edge_v;
    uint32_t material = 0;
};

// One mesh and one instance of it. The four positions of a quad follow each other: corner, + edge_u, + both,
// + edge_v. Quads of dielectrics have to come last.
Scene make_scene(const std::vector<Material>& materials, const std::vector<Quad>& quads);

enum class Facing { inwards, outwards };
std::vector<Quad> box_sides(const vec3& low, const vec3& high, uint32_t material, Facing facing);

// The sides of the box [-1,1]³, with their fronts inside. The camera is inside as well.
Scene closed_box(const Material& material);

// An icosahedron around the origin, each triangle divided into four: 80 triangles of circumscribed radius 1.
// Facing inwards it is closed around the camera, outwards it fills the camera's view.
Scene make_sphere(const Material& material, Facing facing);

// Places the scene's first mesh by this matrix instead of as it is.
void set_transform(Scene& scene, const mat4x3& object_to_world);

}  // namespace lab
