#include "scene/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <span>

#include "parallel.h"
#include "scene/coincident_lights.h"

namespace lab {
namespace {

using glm::dvec3;

// What shaders round off, which compute in float: of positions, relative to coordinates, and of cosines.
constexpr double shader_rounding = 1e-6;

// An emissive triangle in world space.
struct Light {
    dvec3 low, high;  // of its bounding box
    dvec3 normal;     // unit length, on the front
    double area;
    double power;  // area times luminance
    uint32_t index;

    dvec3 centre() const { return 0.5 * (low + high); }
};

// What several lights have in common.
struct Cluster {
    dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    dvec3 normal_sum{0};  // weighted by power
    double power = 0;

    void add(const dvec3& l, const dvec3& h, const dvec3& sum, double p) {
        low = glm::min(low, l), high = glm::max(high, h);
        normal_sum += sum, power += p;
    }
    void add(const Light& light) { add(light.low, light.high, light.power * light.normal, light.power); }
    void add(const Cluster& other) { add(other.low, other.high, other.normal_sum, other.power); }

    // How much light a point wastes on it: grows with power, with the surface of the box, and where normals disagree, as does the
    // solid angle of the directions in which it emits: π for parallel normals, 4π if they point everywhere. For normals that fill
    // a cone evenly, the length of their mean tells its size.
    double cost() const {
        if (power == 0) return 0;
        const dvec3 size = high - low;
        const double surface = size.x * size.y + size.y * size.z + size.z * size.x;
        return power * surface * (1 + 3 * (1 - std::min(glm::length(normal_sum) / power, 1.0)));
    }
};

Light get_light(const Scene& scene, const LightTriangle& triangle, uint32_t index) {
    const Instance& instance = scene.instances[triangle.instance];
    const glm::dmat4x3 transform(instance.object_to_world);
    std::array<dvec3, 3> corners;
    dvec3 magnitude(0);
    for (int i = 0; i < 3; ++i) {
        const dvec3 corner(scene.corner(triangle.triangle, i));
        corners[i] = transform * glm::dvec4(corner, 1);
        for (int axis = 0; axis < 3; ++axis) magnitude += glm::abs(transform[axis] * corner[axis]);
    }
    const dvec3 margin = shader_rounding * (magnitude + glm::abs(transform[3]));
    // The front of a mirrored triangle is where its normal goes, not its winding.
    const auto& c = scene.triangles[triangle.triangle];
    const dvec3 origin(scene.positions[c.x]);
    const dvec3 own_normal = glm::cross(dvec3(scene.positions[c.y]) - origin, dvec3(scene.positions[c.z]) - origin);
    dvec3 normal = glm::dmat3(instance.normal_to_world) * own_normal;
    const double area = 0.5 * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    normal = glm::length(normal) > 0 ? glm::normalize(normal) : dvec3(0, 0, 1);
    return {glm::min(corners[0], glm::min(corners[1], corners[2])) - margin,
            glm::max(corners[0], glm::max(corners[1], corners[2])) + margin,
            normal,
            area,
            area * get_luminance(scene.material_of(triangle.triangle).emission),
            index};
}

class Builder {
  public:
    // Level by level, each in parallel.
    explicit Builder(std::vector<Light> lights) : lights_(std::move(lights)), trails_(lights_.size()) {
        Cluster all;
        for (const Light& light : lights_) all.add(light);
        const double diameter = glm::length(all.high - all.low);
        if (all.power > 0) unit_ = 0.25 * diameter * diameter / all.power;
        std::vector<Part> parts{{.lights = lights_}};
        for (uint32_t depth = 0; !parts.empty(); depth += 2) parts = build_level(parts, depth);
    }

    std::vector<LightNode> take_nodes() { return std::move(nodes_); }
    // The trail of each light, by its index.
    const std::vector<uint32_t>& trails() const { return trails_; }

  private:
    // Lights for which a node is to be built, and which child of its parent it will be.
    struct Part {
        std::span<Light> lights;
        uint32_t trail = 0;
        size_t parent = 0;
        uint32_t place = 0;
    };

    std::vector<Part> build_level(const std::vector<Part>& parts, uint32_t depth) {
        const size_t first = nodes_.size();
        nodes_.resize(first + parts.size());
        std::vector<std::array<Part, 4>> children(parts.size());
        in_parallel(parts.size(), std::max<size_t>(parts.size() / 256, 1), [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) children[i] = build_node(parts[i], depth, first + i);
        });
        std::vector<Part> next;
        for (size_t i = 0; i < parts.size(); ++i) {
            if (depth > 0) nodes_[parts[i].parent].child[parts[i].place] = static_cast<uint32_t>(first + i);
            for (const Part& child : children[i])
                if (child.lights.size() > 1) next.push_back(child);
        }
        return next;
    }

    std::array<Part, 4> build_node(const Part& part, uint32_t depth, size_t index) {
        std::array<Part, 4> children;
        const auto halves = split(part.lights, depth);
        const auto first = split(halves[0], depth + 1), second = split(halves[1], depth + 1);
        const std::array quarters{first[0], first[1], second[0], second[1]};
        LightNode& node = nodes_[index] = {};
        node.radius = vec4(1), node.child = uvec4(IS_LIGHT_LEAF);
        for (uint32_t i = 0; i < 4; ++i) {
            children[i] = {quarters[i], part.trail | i << depth, index, i};
            if (!quarters[i].empty()) set_child(node, i, quarters[i]);
            if (quarters[i].size() != 1) continue;
            node.child[i] += quarters[i][0].index;
            trails_[quarters[i][0].index] = children[i].trail;
        }
        return children;
    }

    void set_child(LightNode& node, uint32_t i, std::span<const Light> lights) const {
        Cluster cluster;
        for (const Light& light : lights) cluster.add(light);
        const vec3 centre(0.5 * (cluster.low + cluster.high));
        const vec3 mean_normal(cluster.power > 0 ? cluster.normal_sum / cluster.power : lights[0].normal);
        double radius = 0, spread = 0;
        for (const Light& light : lights) {
            const dvec3 corner = glm::max(glm::abs(light.low - dvec3(centre)), glm::abs(light.high - dvec3(centre)));
            radius = std::max(radius, glm::dot(corner, corner));
            const dvec3 difference = light.normal - dvec3(mean_normal);
            spread = std::max(spread, glm::dot(difference, difference));
        }
        node.centre_x[i] = centre.x, node.centre_y[i] = centre.y, node.centre_z[i] = centre.z;
        node.mean_normal_x[i] = mean_normal.x, node.mean_normal_y[i] = mean_normal.y, node.mean_normal_z[i] = mean_normal.z;
        node.radius[i] = static_cast<float>((1 + shader_rounding) * std::sqrt(radius));
        node.spread[i] = static_cast<float>(std::sqrt(spread) + shader_rounding);
        node.power[i] = static_cast<float>(unit_ * cluster.power);
    }

    // Reorders the lights into two parts: of all cuts between bins along the axes, takes the one of least cost, unless the tree
    // would become too deep. Only the second part may be empty, and only that of a single light.
    static std::array<std::span<Light>, 2> split(std::span<Light> lights, uint32_t depth) {
        size_t count = (lights.size() + 1) / 2;
        const size_t places = depth % 2 == 0 ? 4 : 2;  // of the node, for these lights: as many of them are leaves, however split
        if (lights.size() > places) {
            dvec3 low{std::numeric_limits<double>::infinity()}, high = -low;
            for (const Light& light : lights) low = glm::min(low, light.centre()), high = glm::max(high, light.centre());
            const dvec3 size = high - low;
            const bool must_halve = std::bit_width(lights.size() - 1) + depth >= max_light_tree_depth - 1;
            if (const size_t cut = must_halve ? 0 : partition(lights, low, size)) {
                count = cut;
            } else {
                const int longest = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
                std::nth_element(lights.begin(), lights.begin() + static_cast<std::ptrdiff_t>(count), lights.end(),
                                 [&](const Light& a, const Light& b) { return a.centre()[longest] < b.centre()[longest]; });
            }
        }
        return {lights.first(count), lights.subspan(count)};
    }

    // Returns how many lights are in the first part, or 0 if no cut divides them.
    static size_t partition(std::span<Light> lights, const dvec3& low, const dvec3& size) {
        const auto bin_count = static_cast<int>(std::min<size_t>(lights.size(), most_bins));
        const dvec3 divisor(size.x > 0 ? size.x : 1, size.y > 0 ? size.y : 1, size.z > 0 ? size.z : 1);
        const auto bins_of = [&](const Light& light) {
            const dvec3 position = (light.centre() - low) / divisor;
            return glm::min(glm::ivec3(position * static_cast<double>(bin_count)), bin_count - 1);
        };
        std::array<std::array<Cluster, most_bins>, 3> bins;
        for (const Light& light : lights) {
            const glm::ivec3 bin = bins_of(light);
            for (int axis = 0; axis < 3; ++axis) bins[axis][bin[axis]].add(light);
        }
        double least = std::numeric_limits<double>::infinity();
        int best_axis = 0, best_cut = 0;
        for (int axis = 0; axis < 3; ++axis) {
            std::array<Cluster, most_bins> below;
            Cluster sum;
            for (int i = 0; i < bin_count; ++i) below[i] = (sum.add(bins[axis][i]), sum);
            sum = {};
            for (int i = bin_count - 1; i > 0 && size[axis] > 0; --i) {
                sum.add(bins[axis][i]);
                const double cost = sum.cost() + below[i - 1].cost();
                if (cost < least) least = cost, best_axis = axis, best_cut = i;
            }
        }
        const auto second = std::partition(lights.begin(), lights.end(),
                                           [&](const Light& light) { return bins_of(light)[best_axis] < best_cut; });
        const auto count = static_cast<size_t>(second - lights.begin());
        return count < lights.size() ? count : 0;
    }

    static constexpr size_t most_bins = 12;
    std::vector<Light> lights_;
    double unit_ = 0;
    std::vector<LightNode> nodes_;
    std::vector<uint32_t> trails_;
};

}  // namespace

LightTree build_light_tree(const Scene& scene, const LightTable& table) {
    if (table.triangles.empty()) return {};
    std::vector<Light> lights(table.triangles.size());
    in_parallel(lights.size(), 1 << 16, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) lights[i] = get_light(scene, table.triangles[i], static_cast<uint32_t>(i));
    });
    std::vector<double> areas;
    for (const Light& light : lights) areas.push_back(light.area);
    Builder builder(std::move(lights));

    LightTree tree{.nodes = builder.take_nodes(), .leaves = {}, .places = std::vector<uint32_t>(scene.triangles.size())};
    std::vector<uint32_t> counts;  // emissive triangles of each mesh
    for (const Mesh& mesh : scene.meshes) {
        counts.push_back(0);
        for (const uint32_t triangle : mesh.triangles())
            if (get_luminance(scene.material_of(triangle).emission) > 0) tree.places[triangle] = counts.back()++;
    }
    uint32_t count = 0;
    for (const uint32_t mesh : scene.instance_meshes) {
        tree.places.push_back(count);
        count += counts[mesh];
    }
    const auto place_of = [&](uint32_t instance, uint32_t triangle) {
        return tree.places[triangle] + tree.places[scene.triangles.size() + instance];
    };
    tree.leaves.resize(count);
    for (size_t i = 0; i < areas.size(); ++i)
        tree.leaves[place_of(table.triangles[i].instance, table.triangles[i].triangle)] = {builder.trails()[i],
                                                                                           static_cast<float>(areas[i])};
    if (count == areas.size()) return tree;
    // The others take the leaves of those in their places.
    std::map<Place, LightLeaf> leaf_at;
    const auto get_light_place = [&](uint32_t i, uint32_t t) { return get_place(scene, scene.instances[i], t); };
    for (const LightTriangle& light : table.triangles)
        leaf_at[get_light_place(light.instance, light.triangle)] = tree.leaves[place_of(light.instance, light.triangle)];
    for (uint32_t i = 0; i < scene.instances.size(); ++i)
        for (const uint32_t triangle : scene.mesh_of(i).triangles())
            if (get_luminance(scene.material_of(triangle).emission) > 0)
                tree.leaves[place_of(i, triangle)] = leaf_at.at(get_light_place(i, triangle));
    return tree;
}

}  // namespace lab
