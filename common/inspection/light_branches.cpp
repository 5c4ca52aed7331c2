#include "inspection/light_branches.h"

#include <limits>

namespace lab {

LightBranches::LightBranches(const Scene& scene)
    : scene_(scene), table_(build_light_table(scene)), tree_(build_light_tree(scene, table_)) {}

void LightBranches::add_to(RecordedPath& path) const {
    for (PathVertex& vertex : path.vertices)
        for (LightSample& light : vertex.light_samples)
            if (light.point) light.branch = find(vertex.position, *light.point);
}

struct LightBranches::Search {
    vec3 from, point;
    float tolerance;  // shadow rays end close to the lamp, not on it
    std::vector<Sphere> here = {}, nearest = {};
    double distance = std::numeric_limits<double>::infinity();
};

std::vector<Sphere> LightBranches::find(const vec3& from, const vec3& point) const {
    Search search{.from = from, .point = point, .tolerance = 1e-5f * (glm::length(point) + glm::distance(from, point))};
    if (!tree_.nodes.empty()) visit(0, search);
    return search.nearest;
}

void LightBranches::visit(uint32_t index, Search& search) const {
    const LightNode& node = tree_.nodes[index];
    for (int i = 0; i < 4; ++i) {
        const Sphere sphere{{node.centre_x[i], node.centre_y[i], node.centre_z[i]}, node.radius[i]};
        const bool is_inside = glm::distance(sphere.centre, search.point) <= sphere.radius + search.tolerance;
        if (!is_inside || node.power[i] == 0) continue;
        search.here.push_back(sphere);
        if (node.child[i] < IS_LIGHT_LEAF) {
            visit(node.child[i], search);
        } else if (const vec3 normal(node.mean_normal_x[i], node.mean_normal_y[i], node.mean_normal_z[i]);
                   glm::dot(normal, search.from - search.point) > 0) {
            const double distance = relative_distance(table_.triangles[node.child[i] - IS_LIGHT_LEAF], search.point);
            if (distance < search.distance) search.distance = distance, search.nearest = search.here;
        }
        search.here.pop_back();
    }
}

// The three triangles between a point and the edges are together as large as the triangle if the point is on it, else larger.
double LightBranches::relative_distance(const LightTriangle& light, const vec3& point) const {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const auto to_corner = [&](int k) {
            return world_corner(scene_, light.instance, light.triangle, k % 3) - glm::dvec3(point);
        };
        sum += 0.5 * glm::length(glm::cross(to_corner(i), to_corner(i + 1)));
    }
    return sum / world_area(scene_, light.instance, light.triangle) - 1;
}

}  // namespace lab
