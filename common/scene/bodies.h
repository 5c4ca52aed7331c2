// Bodies: what bounds media, and which of them is where.
//
// A body is a connected part of the glass or of the open triangles of an instance. Opaque triangles bound nothing. At each point
// there is the smallest body around it, or else the outside. So a body lies in the innermost one around it, whatever the order of
// the file, and where two overlap, there is the smaller one. Of two with the same volume the open one counts as the smaller, or
// else the later one.
#pragma once
#include <array>
#include <optional>

#include "scene/scene.h"

namespace lab {

struct Body {
    uint32_t instance;
    uint32_t part;                    // index among the parts of its mesh
    std::vector<uint32_t> triangles;  // of the scene
    bool is_open;                     // has no surface
    size_t open_edges;                // where it has a hole, or a front meets a back
    double volume;                    // in world space; negative if its fronts face inwards
    Bounds bounds;                    // world space

    // Filled by nest_bodies(), as indices of bodies.
    std::optional<uint32_t> outside;  // the innermost one of those that enclose all of it
    std::vector<uint32_t> overlaps;   // those that its surface runs through, or that run through its own
    bool is_cavity = false;           // of glass: its fronts face inwards, since the glass is around it
    bool is_turned = false;           // its fronts faced the wrong way
};

// All bodies of a scene, the largest first.
std::vector<Body> find_bodies(const Scene& scene);

// Turns closed glass around whose fronts face inwards, with its cavities, and notes that. If other glass is around it, it is a
// cavity of that, unless its own file has a medium to fill it with.
void turn_inside_out_glass(Scene& scene, std::vector<Body>& bodies, const std::vector<bool>& has_medium);

// Finds out what is inside of what. Bodies that only touch must have been separated before, see contacts.h.
void nest_bodies(const Scene& scene, std::vector<Body>& bodies);

// Whether a point lies on a triangle, above or below it, or so close beside that.
bool is_over(const std::array<glm::dvec3, 3>& triangle, const glm::dvec3& point, double tolerance);

// Whether a body is around a point.
bool encloses(const Scene& scene, const Body& body, const glm::dvec3& point);

// If other instances have the same mesh, this one gets a mesh of its own. Its triangles' indices grow by the result.
uint32_t make_own_mesh(Scene& scene, uint32_t instance);

// Adds a copy of a vertex and returns its index.
uint32_t copy_vertex(Scene& scene, uint32_t vertex);

// Notes about boundaries that are not closed, and about bodies that overlap, where there are media.
std::vector<std::string> body_warnings(const Scene& scene, const std::vector<Body>& bodies);

}  // namespace lab
