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
    explicit Builder(std::vector<Light> lights)
        : lights_(std::move(lights)), nodes_(2 * lights_.size() - 1), trails_(lights_.size()) {
        Cluster all;
        for (const Light& light : lights_) all.add(light);
        const double diameter = glm::length(all.high - all.low);
        if (all.power > 0) unit_ = 0.25 * diameter * diameter / all.power;
        // The first levels one after the other, then their subtrees in parallel.
        std::vector<Part> parts{{0, 1, 0, lights_.size(), 0, 0}};
        while (!parts.empty() && parts.size() < 64) {
            std::vector<Part> next;
            for (const Part& part : parts)
                if (const auto halves = build_node(part)) next.insert(next.end(), halves->begin(), halves->end());
            parts = std::move(next);
        }
        in_parallel(parts.size(), 1, [&](size_t begin, size_t) { build(parts[begin]); });
    }

    std::vector<LightNode> take_nodes() { return std::move(nodes_); }
    // The trail of each light, by its index.
    const std::vector<uint32_t>& trails() const { return trails_; }

  private:
    // A subtree to be built: its root, where its further nodes go, and its lights.
    struct Part {
        size_t node, children, begin, end;
        uint32_t trail, depth;
    };

    void build(const Part& part) {
        if (const auto halves = build_node(part))
            for (const Part& half : *halves) build(half);
    }

    std::optional<std::array<Part, 2>> build_node(const Part& part) {
        const std::span<Light> lights(lights_.data() + part.begin, part.end - part.begin);
        Cluster cluster;
        for (const Light& light : lights) cluster.add(light);
        LightNode& node = nodes_[part.node] = get_node(cluster, lights);
        if (lights.size() == 1) {
            node.child = IS_LIGHT_LEAF + lights[0].index;
            trails_[lights[0].index] = part.trail;
            return std::nullopt;
        }
        node.child = static_cast<uint32_t>(part.children);
        const size_t count = split(lights, part.depth), after = part.children + 2;
        const uint32_t depth = part.depth + 1;
        return {
            {{{part.children, after, part.begin, part.begin + count, part.trail, depth},
              {part.children + 1, after + 2 * (count - 1), part.begin + count, part.end, part.trail | 1u << part.depth, depth}}}};
    }

    LightNode get_node(const Cluster& cluster, std::span<const Light> lights) const {
        const vec3 centre(0.5 * (cluster.low + cluster.high));
        const vec3 mean_normal(cluster.power > 0 ? cluster.normal_sum / cluster.power : lights[0].normal);
        double radius = 0, spread = 0;
        for (const Light& light : lights) {
            const dvec3 corner = glm::max(glm::abs(light.low - dvec3(centre)), glm::abs(light.high - dvec3(centre)));
            radius = std::max(radius, glm::dot(corner, corner));
            const dvec3 difference = light.normal - dvec3(mean_normal);
            spread = std::max(spread, glm::dot(difference, difference));
        }
        return {.centre = centre,
                .radius = static_cast<float>((1 + shader_rounding) * std::sqrt(radius)),
                .mean_normal = mean_normal,
                .spread = static_cast<float>(std::sqrt(spread) + shader_rounding),
                .power = static_cast<float>(unit_ * cluster.power),
                .child = 0};
    }

    // Reorders the lights and returns how many go to the first child: of all cuts between bins along the axes, takes the one
    // of least cost, unless the tree would become too deep.
    size_t split(std::span<Light> lights, uint32_t depth) const {
        const size_t half = lights.size() / 2;
        dvec3 low{std::numeric_limits<double>::infinity()}, high = -low;
        for (const Light& light : lights) low = glm::min(low, light.centre()), high = glm::max(high, light.centre());
        const dvec3 size = high - low;
        const bool must_halve = std::bit_width(lights.size() - 1) + depth >= max_light_tree_depth - 1;
        const size_t bin_count = std::min<size_t>(lights.size(), most_bins);
        double least = std::numeric_limits<double>::infinity();
        int best_axis = 0;
        size_t best_cut = 0;
        const auto bin_of = [&](const Light& light, int axis) {
            const double position = (light.centre()[axis] - low[axis]) / size[axis];
            return std::min(static_cast<size_t>(position * static_cast<double>(bin_count)), bin_count - 1);
        };
        for (int axis = 0; axis < 3 && !must_halve; ++axis) {
            if (!(size[axis] > 0)) continue;
            std::array<Cluster, most_bins> bins, below;
            for (const Light& light : lights) bins[bin_of(light, axis)].add(light);
            Cluster sum;
            for (size_t i = 0; i < bin_count; ++i) below[i] = (sum.add(bins[i]), sum);
            sum = {};
            for (size_t i = bin_count - 1; i > 0; --i) {
                sum.add(bins[i]);
                const double cost = sum.cost() + below[i - 1].cost();
                if (cost < least) least = cost, best_axis = axis, best_cut = i;
            }
        }
        if (best_cut > 0) {
            const auto second =
                std::partition(lights.begin(), lights.end(), [&](const Light& l) { return bin_of(l, best_axis) < best_cut; });
            const auto count = static_cast<size_t>(second - lights.begin());
            if (count > 0 && count < lights.size()) return count;
        }
        const int longest = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
        std::nth_element(lights.begin(), lights.begin() + static_cast<std::ptrdiff_t>(half), lights.end(),
                         [&](const Light& a, const Light& b) { return a.centre()[longest] < b.centre()[longest]; });
        return half;
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
