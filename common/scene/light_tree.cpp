#include "scene/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "parallel.h"
#include "scene/coincident_lights.h"

namespace lab {
namespace {

using glm::dvec3;
constexpr double infinity = std::numeric_limits<double>::infinity();

// What shaders round off, which compute in float: of positions, relative to coordinates, and of cosines.
constexpr double shader_rounding = 1e-6;

// Emissive triangles in world space.
struct Cluster {
    dvec3 low{infinity}, high{-infinity};  // of their bounding box
    dvec3 normal_sum{0};                   // of their normals of unit length, on their fronts, times their powers
    double power = 0;                      // area times luminance

    dvec3 centre() const { return 0.5 * (low + high); }
    dvec3 mean_normal() const { return power > 0 ? normal_sum / power : dvec3(0); }

    void add(const Cluster& other) {
        low = glm::min(low, other.low), high = glm::max(high, other.high);
        normal_sum += other.normal_sum, power += other.power;
    }

    // How much light a point wastes on it: grows with power, with the surface of the box, and where normals disagree, as does the
    // solid angle of the directions in which it emits: π for parallel normals, 4π if they point everywhere. For normals that fill
    // a cone evenly, the length of their mean tells its size.
    double cost() const {
        if (power == 0) return 0;
        const dvec3 size = high - low;
        const double surface = size.x * size.y + size.y * size.z + size.z * size.x;
        return surface * (4 * power - 3 * std::min(glm::length(normal_sum), power));
    }
};

struct Light : Cluster {
    uint32_t index = 0;
};

double luminance_of(const Scene& scene, uint32_t triangle) { return get_luminance(scene.material_of(triangle).emission); }

Light get_light(const Scene& scene, const LightTriangle& triangle, uint32_t index) {
    const Instance& instance = scene.instances[triangle.instance];
    const glm::dmat4x3 transform(instance.object_to_world);
    Light light{{}, index};
    light.power = light_area(scene, triangle.instance, triangle.triangle) * luminance_of(scene, triangle.triangle);
    dvec3 magnitude = glm::abs(transform[3]);
    std::array<dvec3, 3> own;  // corners in object space
    for (int i = 0; i < 3; ++i) {
        own[i] = scene.corner(triangle.triangle, i);
        const dvec3 corner = transform * glm::dvec4(own[i], 1);
        light.low = glm::min(light.low, corner), light.high = glm::max(light.high, corner);
        for (int axis = 0; axis < 3; ++axis) magnitude += glm::abs(transform[axis] * own[i][axis]);
    }
    light.low -= shader_rounding * magnitude, light.high += shader_rounding * magnitude;
    // The front of a mirrored triangle is where its normal goes, not its winding.
    const dvec3 normal = glm::dmat3(instance.normal_to_world) * glm::cross(own[1] - own[0], own[2] - own[0]);
    if (light.power > 0) light.normal_sum = light.power * glm::normalize(normal);
    return light;
}

class Builder {
  public:
    // Level by level, each in parallel.
    explicit Builder(std::vector<Light> lights) : trails(lights.size()), lights_(std::move(lights)) {
        Cluster all;
        for (const Light& light : lights_) all.add(light);
        const double diameter = glm::length(all.high - all.low);
        if (all.power > 0) unit_ = 0.25 * diameter * diameter / all.power;
        std::vector<Part> parts{{.lights = lights_}};
        for (uint32_t depth = 0; !parts.empty(); depth += 2) parts = build_level(parts, depth);
    }

    std::vector<LightNode> nodes;
    std::vector<uint32_t> trails;  // of each light, by its index

  private:
    // Lights for which a node is to be built, and which child of its parent it will be.
    struct Part {
        std::span<Light> lights;
        uint32_t trail = 0;
        size_t parent = 0;
        uint32_t place = 0;
    };

    std::vector<Part> build_level(const std::vector<Part>& parts, uint32_t depth) {
        const size_t first = nodes.size();
        nodes.resize(first + parts.size());
        std::vector<std::array<Part, 4>> children(parts.size());
        in_parallel(parts.size(), std::max<size_t>(parts.size() / 256, 1), [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) children[i] = build_node(parts[i], depth, first + i);
        });
        std::vector<Part> next;
        for (size_t i = 0; i < parts.size(); ++i) {
            if (depth > 0) nodes[parts[i].parent].child[parts[i].place] = static_cast<uint32_t>(first + i);
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
        LightNode& node = nodes[index] = {};
        node.radius = vec4(1), node.child = uvec4(IS_LIGHT_LEAF);
        for (uint32_t i = 0; i < 4; ++i) {
            children[i] = {quarters[i], part.trail | i << depth, index, i};
            if (!quarters[i].empty()) set_child(node, i, quarters[i]);
            if (quarters[i].size() != 1) continue;
            node.child[i] += quarters[i][0].index;
            trails[quarters[i][0].index] = children[i].trail;
        }
        return children;
    }

    void set_child(LightNode& node, uint32_t i, std::span<const Light> lights) const {
        Cluster cluster;
        for (const Light& light : lights) cluster.add(light);
        const vec3 centre(cluster.centre()), mean_normal(cluster.mean_normal());
        double radius = 0, spread = 0;
        for (const Light& light : lights) {
            const dvec3 corner = glm::max(glm::abs(light.low - dvec3(centre)), glm::abs(light.high - dvec3(centre)));
            radius = std::max(radius, glm::dot(corner, corner));
            const dvec3 difference = light.mean_normal() - dvec3(mean_normal);
            spread = std::max(spread, glm::dot(difference, difference));
        }
        node.centre_x[i] = centre.x, node.centre_y[i] = centre.y, node.centre_z[i] = centre.z;
        node.mean_normal_x[i] = mean_normal.x, node.mean_normal_y[i] = mean_normal.y, node.mean_normal_z[i] = mean_normal.z;
        node.radius[i] = static_cast<float>((1 + shader_rounding) * std::sqrt(radius));
        node.spread[i] = static_cast<float>(std::sqrt(spread) + shader_rounding);
        node.power[i] = static_cast<float>(unit_ * cluster.power);
    }

    // Reorders the lights into two parts by the cut between bins of least cost over the length of its axis: others leave thin
    // boxes. Halves them where the tree would be too deep. Only the second part may be empty, and only that of a single light.
    static std::array<std::span<Light>, 2> split(std::span<Light> lights, uint32_t depth) {
        const size_t count = (lights.size() + 1) / 2;
        const size_t places = depth % 2 == 0 ? 4 : 2;  // of the node, for these lights: as many of them are leaves, however split
        if (lights.size() > places) {
            dvec3 low{infinity}, high = -low;
            for (const Light& light : lights) low = glm::min(low, light.centre()), high = glm::max(high, light.centre());
            const dvec3 size = high - low;
            const bool must_halve = std::bit_width(lights.size() - 1) + depth >= max_light_tree_depth - 1;
            const size_t cut = must_halve ? 0 : partition(lights, low, size);
            if (cut > 0) return {lights.first(cut), lights.subspan(cut)};
            const int longest = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
            std::nth_element(lights.begin(), lights.begin() + static_cast<std::ptrdiff_t>(count), lights.end(),
                             [&](const Light& a, const Light& b) { return a.centre()[longest] < b.centre()[longest]; });
        }
        return {lights.first(count), lights.subspan(count)};
    }

    // Returns how many lights are in the first part, or 0 if no cut divides them.
    static size_t partition(std::span<Light> lights, const dvec3& low, const dvec3& size) {
        const auto bin_count = static_cast<int>(std::min<size_t>(lights.size(), most_bins));
        const dvec3 scale = static_cast<double>(bin_count) / glm::max(size, 1e-300);
        const auto bin_of = [&](const Light& light, int axis) {
            return std::min(static_cast<int>((light.centre()[axis] - low[axis]) * scale[axis]), bin_count - 1);
        };
        std::array<std::array<Cluster, most_bins>, 3> bins;
        for (const Light& light : lights)
            for (int axis = 0; axis < 3; ++axis) bins[axis][bin_of(light, axis)].add(light);
        double least = infinity;
        int best_axis = 0, best_cut = 0;
        for (int axis = 0; axis < 3; ++axis) {
            std::array<double, most_bins> costs{};  // of the lights below each cut
            Cluster sum;
            for (int i = 1; i < bin_count; ++i) sum.add(bins[axis][i - 1]), costs[i] = sum.cost();
            sum = {};
            for (int i = bin_count - 1; i > 0 && size[axis] > 0; --i) {
                sum.add(bins[axis][i]);
                const double cost = (sum.cost() + costs[i]) / size[axis];
                if (cost < least) least = cost, best_axis = axis, best_cut = i;
            }
        }
        const auto first_of_second =
            std::partition(lights.begin(), lights.end(), [&](const Light& light) { return bin_of(light, best_axis) < best_cut; });
        const auto count = static_cast<size_t>(first_of_second - lights.begin());
        return count < lights.size() ? count : 0;
    }

    static constexpr size_t most_bins = 12;
    std::vector<Light> lights_;
    double unit_ = 0;
};

// Gives each emissive triangle of each instance a leaf.
void place_leaves(const Scene& scene, LightTree& tree) {
    tree.places.resize(scene.triangles.size());
    std::vector<uint32_t> counts(scene.meshes.size());
    for (size_t i = 0; i < counts.size(); ++i)
        for (const uint32_t triangle : scene.meshes[i].triangles())
            if (luminance_of(scene, triangle) > 0) tree.places[triangle] = counts[i]++;
    uint32_t count = 0;
    for (const uint32_t mesh : scene.instance_meshes) tree.places.push_back(std::exchange(count, count + counts[mesh]));
    tree.leaves.resize(count);
}

// `trails` are those of the table's triangles.
void fill_leaves(const Scene& scene, const LightTable& table, const std::vector<uint32_t>& trails, LightTree& tree) {
    const auto leaf_of = [&](uint32_t instance, uint32_t triangle) -> LightLeaf& {
        return tree.leaves[tree.places[triangle] + tree.places[scene.triangles.size() + instance]];
    };
    for (size_t i = 0; i < trails.size(); ++i) {
        const LightTriangle& light = table.triangles[i];
        leaf_of(light.instance, light.triangle) = {trails[i],
                                                   static_cast<float>(light_area(scene, light.instance, light.triangle))};
    }
    if (tree.leaves.size() == trails.size()) return;
    // The others take the leaves of those in their places.
    std::map<Place, LightLeaf> leaf_at;
    for (const LightTriangle& light : table.triangles)
        leaf_at[get_place(scene, scene.instances[light.instance], light.triangle)] = leaf_of(light.instance, light.triangle);
    for (uint32_t i = 0; i < scene.instances.size(); ++i)
        for (const uint32_t triangle : scene.mesh_of(i).triangles())
            if (luminance_of(scene, triangle) > 0)
                leaf_of(i, triangle) = leaf_at.at(get_place(scene, scene.instances[i], triangle));
}

}  // namespace

LightTree build_light_tree(const Scene& scene, const LightTable& table) {
    if (table.triangles.empty()) return {};
    std::vector<Light> lights(table.triangles.size());
    in_parallel(lights.size(), 1 << 16, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) lights[i] = get_light(scene, table.triangles[i], static_cast<uint32_t>(i));
    });
    Builder builder(std::move(lights));
    LightTree tree{.nodes = std::move(builder.nodes), .leaves = {}, .places = {}};
    place_leaves(scene, tree);
    fill_leaves(scene, table, builder.trails, tree);
    return tree;
}

}  // namespace lab
