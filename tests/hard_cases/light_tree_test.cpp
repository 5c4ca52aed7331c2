// The light tree: its probabilities, the lamps that it finds, and what it builds for hard scenes.
#include "scene/light_tree.h"

#include <random>

#include "files/project_folder.h"
#include "support/expect_statistics.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

Estimator light_tree_probe() {
    return {.file = project_folder() / "tests/hard_cases/light_tree.glsl",
            .observed = project_folder() / "chapters/14_many_lights/path_trace.glsl"};
}

// From points anywhere and close to lamps, with and without normals.
void expect_right_probabilities(const Scene& scene, uint32_t size, double largest_bias) {
    constexpr uint32_t batch_count = 16;
    const RenderSettings settings{
        .width = size, .height = size, .samples = 1, .estimator = light_tree_probe(), .backend = fastest_backend()};
    const Batches batches = render_batches(scene, settings, batch_count);
    const auto count = [&](int channel) {
        double sum = 0;
        for (const double mean : batches.means(channel)) sum += mean * size * size;
        return std::round(sum);
    };
    EXPECT_EQ(count(0), 0) << "points whose probabilities do not add up to 1 within 1e-6, of " << batch_count * size * size;
    EXPECT_EQ(count(1), 0) << "lamps that are lost, or draws whose density is not that of their trail";
    expect_mean("1 + frequency - probability", estimate_mean(batches.means(2)), 1, largest_bias, 3);
}

// Quads everywhere, turned all ways, whose radiance spans many decades.
Scene random_lamps(int count, double decades) {
    std::mt19937 numbers(14);
    std::uniform_real_distribution<float> uniform(-1, 1);
    std::vector<Material> materials;
    for (int i = 0; i < 13; ++i)
        materials.push_back(diffuse_material(vec3(0.5f), vec3(static_cast<float>(std::pow(10, -decades * i / 12)))));
    const auto random = [&] { return vec3(uniform(numbers), uniform(numbers), uniform(numbers)); };
    std::vector<Quad> quads;
    for (int i = 0; i < count; ++i)
        quads.push_back({random(), 0.05f * random(), 0.05f * random(), static_cast<uint32_t>(i % 13)});
    return make_scene(materials, quads);
}

TEST(LightTree, ProbabilitiesOfLampsInAHall) { expect_right_probabilities(load_shipped_scene("lamps.json"), 25, 0.005); }
TEST(LightTree, ProbabilitiesOfLampsOfTwelveDecades) { expect_right_probabilities(random_lamps(100, 12), 64, 0.002); }
TEST(LightTree, ProbabilitiesOfOneLamp) { expect_right_probabilities(load_shipped_scene("cornell_box.json"), 64, 0.002); }
// Points are within all nodes.
TEST(LightTree, ProbabilitiesOfALampAroundThem) {
    expect_right_probabilities(make_sphere(diffuse_material(vec3(0), vec3(1)), Facing::inwards), 64, 0.002);
}

// Mirrored and stretched, as an instance: normals and areas change.
TEST(LightTree, ProbabilitiesOfAMirroredAndStretchedInstance) {
    Scene scene = random_lamps(40, 3);
    const glm::mat3 linear(-3, 0.5, 0, 0, 1, 0, 0, 0, 0.2);
    scene.instances[0].object_to_world = glm::mat4x3(linear[0], linear[1], linear[2], vec3(7, 0, 0));
    scene.instances[0].normal_to_world = glm::transpose(glm::inverse(linear));
    expect_right_probabilities(scene, 64, 0.002);
}

// Every trail leads to its leaf, and every node's power is that of its children.
TEST(LightTree, TrailsLeadToLeaves) {
    const Scene scene = load_shipped_scene("lamps.json");
    const LightTable table = build_light_table(scene);
    const LightTree tree = build_light_tree(scene, table);
    ASSERT_EQ(tree.nodes.size(), 2 * table.triangles.size() - 1);
    for (uint32_t i = 0; i < table.triangles.size(); ++i) {
        const LightTriangle& light = table.triangles[i];
        const uint32_t place = tree.places[light.triangle] + tree.places[scene.triangles.size() + light.instance];
        uint32_t child = tree.nodes[0].child, trail = tree.leaves[place].trail;
        for (; child < IS_LIGHT_LEAF; trail >>= 1) child = tree.nodes[child + (trail & 1)].child;
        ASSERT_EQ(child, IS_LIGHT_LEAF + i);
    }
    for (const LightNode& node : tree.nodes)
        if (node.child < IS_LIGHT_LEAF)
            ASSERT_NEAR(node.power, tree.nodes[node.child].power + tree.nodes[node.child + 1].power, 1e-6 * node.power);
}

}  // namespace
}  // namespace lab
