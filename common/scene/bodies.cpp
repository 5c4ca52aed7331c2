#include "scene/bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "scene/pairs.h"

namespace lab {
namespace {

using glm::dvec3;

// A connected part of a mesh.
struct ConnectedPart {
    std::vector<uint32_t> triangles;
    size_t open_edges = 0;
};

std::vector<uint32_t> bounding_triangles(const Scene& scene, const Mesh& mesh) {
    std::vector<uint32_t> triangles;
    for (const uint32_t triangle : mesh.triangles())
        if (mesh.is_open || scene.material_of(triangle).refractive_index > 0) triangles.push_back(triangle);
    return triangles;
}

// A number for each corner of the triangles. Corners in one place have the same, whatever their normals.
std::vector<uint32_t> weld_corners(const Scene& scene, const std::vector<uint32_t>& triangles) {
    std::vector<std::pair<std::array<float, 3>, uint32_t>> places;
    for (const uint32_t triangle : triangles)
        for (int i = 0; i < 3; ++i) {
            const vec3 place = scene.corner(triangle, i) + 0.0f;  // removes negative zeros
            places.push_back({{place.x, place.y, place.z}, static_cast<uint32_t>(places.size())});
        }
    std::ranges::sort(places);
    std::vector<uint32_t> numbers(places.size());
    uint32_t number = 0;
    for (size_t i = 0; i < places.size(); ++i) {
        number += i > 0 && places[i].first != places[i - 1].first;
        numbers[places[i].second] = number;
    }
    return numbers;
}

// A side of a triangle, between welded corners.
struct Side {
    std::pair<uint32_t, uint32_t> edge;  // the smaller number first
    int direction;                       // +1 from the smaller to the larger one, else -1
    uint32_t triangle;                   // index into the triangles of the parts
    auto operator<=>(const Side&) const = default;
};

// By which angle a side's triangle has to turn about its edge, into what is behind its front, to meet another triangle there.
double angle_to(const Scene& scene, const std::vector<uint32_t>& triangles, const std::vector<uint32_t>& corners,
                const Side& side, const Side& other) {
    const auto opposite_corner = [&](const Side& of) {
        uint32_t i = 3 * of.triangle;
        while (corners[i] == of.edge.first || corners[i] == of.edge.second) ++i;
        return dvec3(scene.corner(triangles[of.triangle], static_cast<int>(i % 3)));
    };
    const auto place = [&](uint32_t number) {
        uint32_t i = 3 * side.triangle;
        while (corners[i] != number) ++i;
        return dvec3(scene.corner(triangles[side.triangle], static_cast<int>(i % 3)));
    };
    const dvec3 origin = place(side.edge.first);
    const dvec3 along = glm::normalize((place(side.edge.second) - origin) * static_cast<double>(side.direction));
    const auto across = [&](const dvec3& corner) {
        const dvec3 v = corner - origin;
        return glm::normalize(v - glm::dot(v, along) * along);
    };
    const dvec3 into = across(opposite_corner(side)), behind = glm::cross(into, along), v = across(opposite_corner(other));
    const double angle = std::atan2(glm::dot(v, behind), glm::dot(v, into));
    // Of two in one place, the one is meant whose vertices are the same, not only their positions.
    const auto is_shared = [&](uint32_t vertex) {
        const uvec3& own = scene.triangles[triangles[side.triangle]];
        return vertex == own.x || vertex == own.y || vertex == own.z;
    };
    const uvec3& its = scene.triangles[triangles[other.triangle]];
    const double tie = is_shared(its.x) || is_shared(its.y) || is_shared(its.z) ? 0 : 1e-6;
    return (angle < 1e-9 ? angle + 2 * std::numbers::pi : angle) + tie;
}

// Triangles are connected at their sides. Where more than two meet, as where closed parts touch, those are that have nothing of
// their part between them.
std::vector<ConnectedPart> find_parts(const Scene& scene, const Mesh& mesh) {
    const std::vector<uint32_t> triangles = bounding_triangles(scene, mesh), corners = weld_corners(scene, triangles);
    std::vector<uint32_t> parents(triangles.size());
    std::iota(parents.begin(), parents.end(), 0u);
    const auto root_of = [&](uint32_t triangle) {
        while (parents[triangle] != triangle) triangle = parents[triangle] = parents[parents[triangle]];
        return triangle;
    };
    std::vector<Side> sides;
    for (uint32_t i = 0; i < corners.size(); ++i) {
        const uint32_t from = corners[i], to = corners[i % 3 == 2 ? i - 2 : i + 1];
        sides.push_back({std::minmax(from, to), from < to ? 1 : -1, i / 3});
    }
    std::ranges::sort(sides);
    std::vector<uint32_t> open_sides;  // a triangle of each edge that is open
    for (size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
        int sum = 0;
        for (; end < sides.size() && sides[end].edge == sides[begin].edge; ++end) sum += sides[end].direction;
        if (sum != 0) open_sides.push_back(sides[begin].triangle);
        const std::span here(sides.begin() + static_cast<std::ptrdiff_t>(begin), end - begin);
        for (const Side& side : here) {
            const Side* mate = &here[0];
            double smallest = INFINITY;
            for (const Side& other : here) {
                if (here.size() == 2 ? &other == &side : other.direction == side.direction) continue;
                const double angle = here.size() == 2 ? 0 : angle_to(scene, triangles, corners, side, other);
                if (angle < smallest) smallest = angle, mate = &other;
            }
            if (here.size() == 2 || side.direction > 0 || sum != 0) parents[root_of(side.triangle)] = root_of(mate->triangle);
        }
    }
    std::vector<ConnectedPart> parts;
    std::vector<uint32_t> part_of_root(triangles.size(), UINT32_MAX);
    for (uint32_t i = 0; i < triangles.size(); ++i) {
        uint32_t& part = part_of_root[root_of(i)];
        if (part == UINT32_MAX) part = static_cast<uint32_t>(parts.size()), parts.emplace_back();
        parts[part].triangles.push_back(triangles[i]);
    }
    for (const uint32_t triangle : open_sides) ++parts[part_of_root[root_of(triangle)]].open_edges;
    return parts;
}

// Mirrored instances are wound the other way.
double winding_sign(const Scene& scene, uint32_t instance) {
    return glm::determinant(glm::dmat3(mat3(scene.instances[instance].object_to_world))) < 0 ? -1 : 1;
}

std::array<dvec3, 3> world_corners(const Scene& scene, const Body& body, uint32_t triangle) {
    const auto corner = [&](int i) { return world_corner(scene, body.instance, triangle, i); };
    return {corner(0), corner(1), corner(2)};
}

Body make_body(const Scene& scene, uint32_t instance, uint32_t index, const ConnectedPart& part) {
    Body body{instance, index, part.triangles, scene.mesh_of(instance).is_open, part.open_edges, 0, {}, {}, {}};
    const dvec3 origin = world_corner(scene, instance, part.triangles[0], 0);
    for (const uint32_t triangle : part.triangles) {
        const auto [a, b, c] = world_corners(scene, body, triangle);
        body.volume += glm::dot(a - origin, glm::cross(b - origin, c - origin)) / 6;
        for (const dvec3& corner : {a, b, c}) body.bounds.grow(vec3(corner));
    }
    body.volume *= winding_sign(scene, instance);
    return body;
}

// The solid angle of a triangle seen from the origin, with a sign (van Oosterom and Strackee 1983).
double solid_angle(const dvec3& a, const dvec3& b, const dvec3& c) {
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    return 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                          la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

// A point on a body's surface: the middle of its largest triangle.
dvec3 point_on(const Scene& scene, const Body& body) {
    const uint32_t triangle =
        *std::ranges::max_element(body.triangles, {}, [&](uint32_t i) { return world_area(scene, body.instance, i); });
    const auto [a, b, c] = world_corners(scene, body, triangle);
    return (a + b + c) / 3.0;
}

// Where the segment from p to q meets a triangle, unless it only touches the triangle's plane with an end.
std::optional<dvec3> crossing(const dvec3& p, const dvec3& q, const std::array<dvec3, 3>& triangle, double tolerance) {
    const auto& [a, b, c] = triangle;
    const dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    const double from = glm::dot(p - a, normal), to = glm::dot(q - a, normal);
    if (!(std::min(from, to) < -tolerance && std::max(from, to) > tolerance)) return std::nullopt;
    const dvec3 point = p + from / (from - to) * (q - p);
    return is_over(triangle, point, tolerance) ? std::optional(point) : std::nullopt;
}

std::vector<Bounds> boxes_of(const Scene& scene, const Body& body) {
    std::vector<Bounds> boxes;
    for (const uint32_t triangle : body.triangles) {
        boxes.emplace_back();
        for (const dvec3& corner : world_corners(scene, body, triangle)) boxes.back().grow(vec3(corner));
    }
    return boxes;
}

// Whether the surface of one body runs through that of another. Where they meet only at corners or edges, it does not.
bool cross_each_other(const Scene& scene, const Body& a, const Body& b) {
    const Bounds space{glm::max(a.bounds.low, b.bounds.low), glm::min(a.bounds.high, b.bounds.high)};
    // Below the distance by which contacts.h separates what touches, and above the rounding errors of positions.
    const dvec3 largest = glm::max(glm::abs(dvec3(space.low)), glm::abs(dvec3(space.high)));
    const double tolerance = start_distance(largest);
    bool is_found = false;
    const auto search = [&](const std::array<dvec3, 3>& edges, const std::array<dvec3, 3>& triangle, const Body& of_triangle) {
        for (size_t k = 0; k < 3 && !is_found; ++k) {
            const dvec3 &p = edges[k], &q = edges[(k + 1) % 3];
            const auto point = crossing(p, q, triangle, tolerance);
            if (!point) continue;
            const dvec3 step = 2 * tolerance * glm::normalize(q - p);
            is_found = encloses(scene, of_triangle, *point - step) != encloses(scene, of_triangle, *point + step);
        }
    };
    for_each_overlap(boxes_of(scene, a), boxes_of(scene, b), space, [&](uint32_t i, uint32_t j) {
        if (is_found) return;
        const auto x = world_corners(scene, a, a.triangles[i]), y = world_corners(scene, b, b.triangles[j]);
        search(x, y, b);
        search(y, x, a);
    });
    return is_found;
}

// Gives a body new corners, whose order and normals are turned around.
void turn_around(Scene& scene, std::vector<Body>& bodies, Body& body) {
    const uint32_t moved = make_own_mesh(scene, body.instance);
    for (Body& other : bodies)
        if (other.instance == body.instance)
            for (uint32_t& triangle : other.triangles) triangle += moved;
    for (const uint32_t triangle : body.triangles) {
        const uvec3 corners = scene.triangles[triangle];
        for (int i = 0; i < 3; ++i) {
            const uint32_t vertex = scene.triangles[triangle][i] = copy_vertex(scene, corners[i == 0 ? 0 : 3 - i]);
            if (!scene.normals.empty()) scene.normals[vertex] = -scene.normals[vertex];
        }
    }
    body.volume = -body.volume;
}

const std::string& file_of(const Scene& scene, const Body& body) { return scene.mesh_of(body.instance).file; }

// Light fades in absorbing glass up to the glass's own surface only.
void note_absorption(const Scene& scene, const std::vector<Body>& bodies, std::vector<std::string>& warnings) {
    for (const Body& body : bodies) {
        const auto absorbs = [&](uint32_t other) {
            return !bodies[other].is_open && scene.material_of(bodies[other].triangles[0]).absorption != vec3(0);
        };
        const auto found = std::ranges::find_if(body.overlaps, absorbs);
        const bool is_inside = body.outside && absorbs(*body.outside) && !body.is_cavity &&
                               std::abs(body.volume) < 0.999 * bodies[*body.outside].volume;  // it may fill all of the glass
        if (!is_inside && found == body.overlaps.end()) continue;
        const Body& glass = bodies[is_inside ? *body.outside : *found];
        warnings.push_back(file_of(scene, body) + ": lies in the absorbing glass of " + file_of(scene, glass) +
                           ": Tf acts only where a ray arrives at the glass's surface from within, so light does not fade on its "
                           "way from there to here; give that glass a \"medium\" in place of Tf");
        return;
    }
}

}  // namespace

std::vector<Body> find_bodies(const Scene& scene) {
    std::vector<std::vector<ConnectedPart>> parts;
    for (const Mesh& mesh : scene.meshes) parts.push_back(find_parts(scene, mesh));
    std::vector<Body> bodies;
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance) {
        uint32_t index = 0;
        for (const ConnectedPart& part : parts[scene.instance_meshes[instance]])
            bodies.push_back(make_body(scene, instance, index++, part));
    }
    // In 32 bits, in which meshes of the same shape have the same volume, whatever the order of their triangles.
    std::ranges::stable_sort(
        bodies, {}, [](const Body& body) { return std::pair(-std::abs(static_cast<float>(body.volume)), body.is_open); });
    return bodies;
}

bool is_over(const std::array<dvec3, 3>& triangle, const dvec3& point, double tolerance) {
    const dvec3 normal = glm::normalize(glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
    for (size_t i = 0; i < 3; ++i) {
        const dvec3 edge = triangle[(i + 1) % 3] - triangle[i];
        if (!(glm::dot(normal, glm::cross(edge, point - triangle[i])) >= -tolerance * glm::length(edge))) return false;
    }
    return true;
}

bool encloses(const Scene& scene, const Body& body, const dvec3& point) {
    if (!overlap(body.bounds, {vec3(point), vec3(point)})) return false;
    double sum = 0;
    for (const uint32_t triangle : body.triangles) {
        const auto [a, b, c] = world_corners(scene, body, triangle);
        sum += solid_angle(a - point, b - point, c - point);
    }
    return sum * winding_sign(scene, body.instance) * (body.volume < 0 ? -1 : 1) > 2 * std::numbers::pi;
}

uint32_t make_own_mesh(Scene& scene, uint32_t instance) {
    if (std::ranges::count(scene.instance_meshes, scene.instance_meshes[instance]) == 1) return 0;
    Mesh mesh = scene.mesh_of(instance);
    const auto first = static_cast<uint32_t>(scene.triangles.size()), moved = first - mesh.first_triangle;
    for (const uint32_t triangle : mesh.triangles()) {
        scene.triangles.push_back(uvec3(scene.triangles[triangle]));
        scene.triangle_materials.push_back(uint32_t{scene.triangle_materials[triangle]});
    }
    for (size_t i = 0, count = scene.double_sided.size(); i < count; ++i)
        if (const uvec2 sides = scene.double_sided[i]; sides.x - mesh.first_triangle < mesh.triangle_count)
            scene.double_sided.push_back(sides + moved);
    mesh.first_triangle = first;
    scene.instance_meshes[instance] = static_cast<uint32_t>(scene.meshes.size());
    scene.meshes.push_back(mesh);
    return moved;
}

uint32_t copy_vertex(Scene& scene, uint32_t vertex) {
    scene.positions.push_back(vec3(scene.positions[vertex]));
    if (!scene.normals.empty()) scene.normals.push_back(vec3(scene.normals[vertex]));
    if (!scene.texture_coordinates.empty()) scene.texture_coordinates.push_back(vec2(scene.texture_coordinates[vertex]));
    return static_cast<uint32_t>(scene.positions.size() - 1);
}

void turn_inside_out_glass(Scene& scene, std::vector<Body>& bodies, const std::vector<bool>& has_medium) {
    for (Body& body : bodies) {  // the largest first
        if (body.is_open || body.open_edges > 0) continue;
        const dvec3 point = point_on(scene, body);
        const auto is_in = [&](const Body& other) {
            return &other != &body && !other.is_open && std::abs(other.volume) > std::abs(body.volume) &&
                   encloses(scene, other, point);
        };
        if (body.volume < 0) {
            body.is_cavity = std::ranges::any_of(bodies, [&](const Body& other) {
                return is_in(other) && (other.instance == body.instance || !has_medium[body.instance]);
            });
            if (body.is_cavity) continue;
            scene.warnings.push_back(file_of(scene, body) + ": the fronts of its glass face inwards: turned around");
        } else if (std::ranges::none_of(bodies, [&](const Body& other) {
                       return other.is_turned && other.instance == body.instance && is_in(other);
                   })) {
            continue;
        }
        // With a shell its cavities are turned around, too.
        body.is_turned = true;
        body.is_cavity = body.volume > 0;
        turn_around(scene, bodies, body);
    }
}

void nest_bodies(const Scene& scene, std::vector<Body>& bodies) {
    for (uint32_t i = 0; i < bodies.size(); ++i) {
        const dvec3 point = point_on(scene, bodies[i]);
        for (uint32_t j = 0; j < i; ++j) {
            if (!overlap(bodies[i].bounds, bodies[j].bounds)) continue;
            if (cross_each_other(scene, bodies[i], bodies[j])) {
                bodies[i].overlaps.push_back(j);
                bodies[j].overlaps.push_back(i);
            } else if (encloses(scene, bodies[j], point)) {
                bodies[i].outside = j;  // the smallest one comes last
            }
        }
    }
}

std::vector<std::string> body_warnings(const Scene& scene, const std::vector<Body>& bodies) {
    std::vector<std::string> warnings;
    const auto is_leaky = [](const Body& body) { return body.is_open && body.open_edges > 0; };
    if (const auto leaky = std::ranges::find_if(bodies, is_leaky); leaky != bodies.end())
        warnings.push_back(file_of(scene, *leaky) + ": the boundary of its medium is not closed: it has " +
                           std::to_string(leaky->open_edges) +
                           " open edges, or edges where a front meets a back; "
                           "behind a hole it is not clear which medium is where, and light may be lost");
    for (const Body& body : bodies) {
        if (body.overlaps.empty()) continue;
        const Body& other = bodies[body.overlaps.back()];
        warnings.push_back(file_of(scene, body) + ": overlaps with " + file_of(scene, other) +
                           ": where both are, there is the medium of the smaller one, " + file_of(scene, other));
        break;
    }
    note_absorption(scene, bodies, warnings);
    return warnings;
}

}  // namespace lab
