#include "scene/contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <tuple>

#include "scene/pairs.h"

namespace lab {
namespace {

using glm::dmat3;
using glm::dvec3;

constexpr uint64_t max_searched_triangles = 10'000'000;

// A triangle in world space.
struct Face {
    std::array<dvec3, 3> corners;
    dvec3 normal;     // unit length, on the front
    double offset;    // the distance at which rays start, as get_surface_point() in shaders/world/shading_data.glsl has it
    double rounding;  // the same for a triangle that is not slender
};

double error_bound(const dvec3& magnitude, const dvec3& edge_1, const dvec3& edge_2) {
    const auto largest = [](const dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
    const double size = std::max(largest(edge_1), largest(edge_2));
    const double slenderness = 1 / std::max(largest(glm::cross(edge_1 / size, edge_2 / size)), 1.0 / 256);
    return start_distance(magnitude) * slenderness;
}

Face make_face(const Scene& scene, uint32_t instance, uint32_t triangle) {
    const glm::dmat4x3 matrix(scene.instances[instance].object_to_world);
    const dmat3 linear(matrix), sizes(glm::abs(linear[0]), glm::abs(linear[1]), glm::abs(linear[2]));
    Face face;
    dvec3 own_magnitude(0), magnitude(0);
    for (int i = 0; i < 3; ++i) {
        const dvec3 corner(scene.corner(triangle, i));
        face.corners[static_cast<size_t>(i)] = matrix * glm::dvec4(corner, 1);
        own_magnitude = glm::max(own_magnitude, glm::abs(corner));
        magnitude = glm::max(magnitude, sizes * glm::abs(corner) + glm::abs(matrix[3]));
    }
    const dvec3 origin(scene.corner(triangle, 0));
    const dvec3 edge_1 = dvec3(scene.corner(triangle, 1)) - origin, edge_2 = dvec3(scene.corner(triangle, 2)) - origin;
    const dvec3 normal = glm::transpose(glm::inverse(linear)) * glm::normalize(glm::cross(edge_1, edge_2));
    face.normal = glm::normalize(normal);
    face.offset = std::max(error_bound(own_magnitude, edge_1, edge_2) / glm::length(normal),
                           error_bound(magnitude, linear * edge_1, linear * edge_2));
    face.rounding = start_distance(magnitude);
    return face;
}

// Whether two triangles lie in one plane and overlap there, within the distance that rays start from them.
bool touch(const Face& a, const Face& b) {
    if (std::abs(glm::dot(a.normal, b.normal)) < 0.9999) return false;
    const double tolerance = 2 * std::max(a.offset, b.offset);
    const auto is_near = [&](const Face& face, const Face& plane) {
        return std::ranges::all_of(face.corners, [&](const dvec3& corner) {
            return std::abs(glm::dot(corner - plane.corners[0], plane.normal)) <= tolerance;
        });
    };
    if (!is_near(a, b) && !is_near(b, a)) return false;
    // Two convex shapes are apart if they are so along the normal of an edge.
    const auto is_apart = [&](const dvec3& axis) {
        const auto range = [&](const Face& face) {
            return std::ranges::minmax(
                {glm::dot(face.corners[0], axis), glm::dot(face.corners[1], axis), glm::dot(face.corners[2], axis)});
        };
        const auto [low_a, high_a] = range(a);
        const auto [low_b, high_b] = range(b);
        return std::min(high_a, high_b) - std::max(low_a, low_b) <= tolerance;
    };
    for (const Face* face : {&a, &b})
        for (size_t i = 0; i < 3; ++i)
            if (is_apart(glm::normalize(glm::cross(face->normal, face->corners[(i + 1) % 3] - face->corners[i])))) return false;
    return true;
}

// Whether a corner of one triangle lies on the other.
bool touch_at_a_corner(const Face& a, const Face& b) {
    const double tolerance = 2 * std::max(a.rounding, b.rounding);
    const auto is_on = [&](const Face& face, const dvec3& corner) {
        return std::abs(glm::dot(corner - face.corners[0], face.normal)) <= tolerance && is_over(face.corners, corner, tolerance);
    };
    return std::ranges::any_of(b.corners, [&](const dvec3& corner) { return is_on(a, corner); }) ||
           std::ranges::any_of(a.corners, [&](const dvec3& corner) { return is_on(b, corner); });
}

// How far a triangle moves.
struct Move {
    dvec3 direction{0};
    double distance = 0;
};

// Triangles that move together: a body, or those of one opaque material in an instance.
struct Group {
    uint32_t instance;
    std::vector<uint32_t> triangles;
    uint32_t material;
    bool emits;
    Body* body;
    Bounds bounds;
    std::vector<Bounds> boxes;
    std::map<uint32_t, Move> moves;  // by index into triangles

    dvec3 direction(const Face& face) const { return body && body->volume >= 0 ? -face.normal : face.normal; }
};

class Separation {
  public:
    Separation(Scene& scene, std::vector<Body>& bodies) : scene_(scene) {
        add_opaque_groups();
        for (Body& body : bodies) add_group({body.instance, body.triangles, UINT32_MAX, false, &body, {}, {}, {}});
    }

    void run() {
        for (size_t later = 1; later < groups_.size(); ++later)
            for (size_t earlier = 0; earlier < later; ++earlier)
                if (overlap(groups_[earlier].bounds, groups_[later].bounds)) compare(groups_[earlier], groups_[later]);
        for (Group& group : groups_)
            if (!group.moves.empty()) move(group);
    }

  private:
    // Lamps come after what is dark.
    void add_opaque_groups() {
        std::map<std::tuple<bool, uint32_t, uint32_t>, std::vector<uint32_t>> found;
        if (instanced_triangle_count(scene_) > max_searched_triangles) return;
        for (uint32_t instance = 0; instance < scene_.instances.size(); ++instance) {
            if (scene_.mesh_of(instance).is_open) continue;
            for (const uint32_t triangle : scene_.mesh_of(instance).triangles())
                if (const Material& material = scene_.material_of(triangle); material.refractive_index == 0)
                    found[{material.emission != vec3(0), instance, scene_.triangle_materials[triangle]}].push_back(triangle);
        }
        for (auto& [key, triangles] : found) {
            const auto [emits, instance, material] = key;
            add_group({instance, std::move(triangles), material, emits, nullptr, {}, {}, {}});
        }
    }

    void add_group(Group group) {
        for (const uint32_t triangle : group.triangles) {
            Bounds box;
            for (int i = 0; i < 3; ++i) box.grow(vec3(world_corner(scene_, group.instance, triangle, i)));
            // By more than any tolerance of touch().
            const vec3 size = glm::max(glm::abs(box.low), glm::abs(box.high));
            const float margin = 2.5e-4f * (size.x + size.y + size.z);
            box.low -= margin, box.high += margin;
            group.bounds.grow(box.low), group.bounds.grow(box.high);
            group.boxes.push_back(box);
        }
        groups_.push_back(std::move(group));
    }

    bool is_double_sided(uint32_t a, uint32_t b) const {
        return std::ranges::any_of(scene_.double_sided,
                                   [&](const uvec2& sides) { return std::minmax(sides.x, sides.y) == std::minmax(a, b); });
    }

    bool look_the_same(uint32_t a, uint32_t b) const {
        return a == b ||
               (scene_.microfacets.empty() && std::memcmp(&scene_.materials[a], &scene_.materials[b], sizeof(Material)) == 0);
    }

    // Moves triangles of the later group that touch the earlier one. A ball in a box does so with corners.
    void compare(const Group& earlier, Group& later) {
        if (!compare(earlier, later, touch, &Face::offset) && earlier.body && later.body)
            compare(earlier, later, touch_at_a_corner, &Face::rounding);
    }

    bool compare(const Group& earlier, Group& later, bool (*touches)(const Face&, const Face&), double Face::*gap) {
        // In one mesh, only lamps are told from what is dark. Elsewhere, two that look the same need no order.
        const bool is_decoration = !later.body && !later.emits;
        if (!later.body && earlier.emits == later.emits && earlier.instance == later.instance) return false;
        if (is_decoration && look_the_same(earlier.material, later.material)) return false;
        bool is_found = false;
        const Bounds space{glm::max(earlier.bounds.low, later.bounds.low), glm::min(earlier.bounds.high, later.bounds.high)};
        for_each_overlap(earlier.boxes, later.boxes, space, [&](uint32_t i, uint32_t j) {
            const Face a = make_face(scene_, earlier.instance, earlier.triangles[i]);
            const Face b = make_face(scene_, later.instance, later.triangles[j]);
            if (!touches(a, b)) return;
            is_found = true;
            const bool faces_the_same_way = glm::dot(a.normal, b.normal) > 0;
            if (is_decoration && !faces_the_same_way) return;  // as a box that stands on a floor
            if (earlier.instance == later.instance && is_double_sided(earlier.triangles[i], later.triangles[j])) return;
            const auto before = earlier.moves.find(i);
            const dvec3 direction = later.direction(b);
            const bool follows = before != earlier.moves.end() && glm::dot(before->second.direction, direction) > 0;
            Move& move = later.moves[j];
            move.direction = direction;
            move.distance = std::max(move.distance, (follows ? before->second.distance : 0) + 6 * std::max(a.*gap, b.*gap));
            if (!later.body && later.emits == earlier.emits && faces_the_same_way) note(earlier, later);
        });
        return is_found;
    }

    void note(const Group& earlier, const Group& later) {
        const std::string &file = scene_.mesh_of(later.instance).file, &other = scene_.mesh_of(earlier.instance).file;
        if (noted_.emplace(file, other).second)
            scene_.warnings.push_back(file + ": lies in the plane of " + (file == other ? "another placement of it" : other) +
                                      ", and is shown in front of it, as if it lay on top; move one of them");
    }

    // Moves corners far enough for each triangle there that moves, with all triangles of the group that share them.
    void move(Group& group) {
        const uint32_t moved = make_own_mesh(scene_, group.instance);
        for (Group& other : groups_) {
            if (other.instance != group.instance) continue;
            for (uint32_t& triangle : other.triangles) triangle += moved;
            if (other.body) other.body->triangles = other.triangles;
        }
        const auto key = [&](uint32_t vertex) {
            const vec3 place = scene_.positions[vertex] + 0.0f;
            return std::array{place.x, place.y, place.z};
        };
        std::map<std::array<float, 3>, std::vector<Move>> moves;
        for (const auto& [index, move] : group.moves)
            for (int i = 0; i < 3; ++i) moves[key(scene_.triangles[group.triangles[index]][i])].push_back(move);
        const dmat3 to_object = glm::inverse(dmat3(mat3(scene_.instances[group.instance].object_to_world)));
        std::map<uint32_t, uint32_t> copies;
        for (const uint32_t triangle : group.triangles)
            for (int i = 0; i < 3; ++i) {
                const uint32_t vertex = scene_.triangles[triangle][i];
                const auto found = moves.find(key(vertex));
                if (found == moves.end()) continue;
                const auto [copy, is_new] = copies.try_emplace(vertex, 0);
                if (is_new) {
                    copy->second = copy_vertex(scene_, vertex);
                    vec3& place = scene_.positions[copy->second];
                    place = vec3(dvec3(place) + to_object * displacement(found->second));
                }
                scene_.triangles[triangle][i] = copy->second;
            }
    }

    // A vector that goes far enough in each direction, by repeated projection (Kaczmarz).
    static dvec3 displacement(const std::vector<Move>& moves) {
        dvec3 result(0);
        for (int round = 0; round < 32; ++round)
            for (const Move& move : moves)
                result += std::max(0.0, move.distance - glm::dot(result, move.direction)) * move.direction;
        return result;
    }

    Scene& scene_;
    std::vector<Group> groups_;
    std::set<std::pair<std::string, std::string>> noted_;
};

}  // namespace

void separate_contacts(Scene& scene, std::vector<Body>& bodies) { Separation(scene, bodies).run(); }

}  // namespace lab
