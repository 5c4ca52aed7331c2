// The light tree: its probabilities, the lamps that it finds, and what it builds for hard scenes.
#include "scene/light_tree.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "files/project_folder.h"
#include "inspection/light_branches.h"
#include "support/expect_statistics.h"
#include "support/lambert_polygon.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;

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

TEST(LightTree, ProbabilitiesOfLampsInAHall) { expect_right_probabilities(load_shipped_scene("lamps.json"), 25, 0.005); }
// 10⁸ times a lamp is looked for at a point.
TEST(LightTree, ProbabilitiesAtMorePointsOfAHall_all) { expect_right_probabilities(load_shipped_scene("lamps.json"), 40, 0.003); }
TEST(LightTree, ProbabilitiesOfLampsOfTwelveDecades) { expect_right_probabilities(random_lamps(100, 12), 64, 0.002); }
TEST(LightTree, ProbabilitiesOfTwoLamps) { expect_right_probabilities(random_lamps(2, 1), 64, 0.002); }
// There is little to choose, and the table costs less.
TEST(LightTree, IsLeftOutForALampOfTwoTriangles) {
    const auto has_tree = [](const Scene& scene) {
        const GpuScene gpu_scene = make_gpu_scene(scene, {.estimator = chapter_estimator(chapter_named("many_lights"))});
        return std::ranges::count(gpu_scene.defines(), "FEATURE_LIGHT_TREE") == 1;
    };
    EXPECT_FALSE(has_tree(load_shipped_scene("cornell_box.json")));
    EXPECT_TRUE(has_tree(random_lamps(2, 1)));
}
// Points are within all nodes.
TEST(LightTree, ProbabilitiesOfALampAroundThem) {
    expect_right_probabilities(make_sphere(diffuse_material(vec3(0), vec3(1)), Facing::inwards), 64, 0.002);
}

// Lamps with the same centre, and some that are much smaller than all others.
TEST(LightTree, ProbabilitiesOfLampsInOnePlace) {
    std::vector<Quad> tiny;
    for (int i = 0; i < 20; ++i) {
        const vec3 u(std::cos(static_cast<float>(i)), std::sin(static_cast<float>(i)), 0.3f), v(0.2f, 0.1f, 1);
        const float size = i % 2 == 0 ? 0.1f : 1e-6f;
        tiny.push_back({-0.5f * size * (u + v), size * u, size * v, 1});
    }
    expect_right_probabilities(random_lamps(20, 3, 0.05f, tiny), 64, 0.002);
}

// Mirrored and stretched: normals and areas change.
Scene stretched_lamps() {
    Scene scene = random_lamps(40, 3);
    const glm::mat3 linear(-3, 0.5, 0, 0, 1, 0, 0, 0, 0.2);
    scene.instances[0].object_to_world = glm::mat4x3(linear[0], linear[1], linear[2], vec3(7, 0, 0));
    scene.instances[0].normal_to_world = glm::transpose(glm::inverse(linear));
    return scene;
}
TEST(LightTree, ProbabilitiesOfAMirroredAndStretchedInstance) { expect_right_probabilities(stretched_lamps(), 64, 0.002); }

// Positions are rounded to more than the size of some lamps.
TEST(LightTree, ProbabilitiesOfLampsFarFromTheOrigin) {
    Scene scene = random_lamps(40, 3, 1e-3f);
    scene.instances[0].object_to_world[3] = vec3(3e4f, -2e4f, 1e4f);
    expect_right_probabilities(scene, 64, 0.002);
}

// Its density would overflow: 1 over an area of 5e-41. It sends too little light to be seen, whoever chooses it.
TEST(LightTree, ALampThatIsSmallerThanFloatsIsHarmless) {
    const Quad lamp{{0.3f, 0.2f, 0}, {0, 0.5f, 0}, {0.5f, 0, 0}, 2}, tiny{vec3(0), {0, 1e-20f, 0}, {1e-20f, 0, 0}, 3};
    Scene scene = make_scene({diffuse_material(vec3(0.8f)), diffuse_material(vec3(0)), diffuse_material(vec3(0), vec3(1)),
                              diffuse_material(vec3(0), vec3(1e6f))},
                             {{{-1, -1, -0.8f}, {2, 0, 0}, {0, 2, 0}, 0}, lamp, tiny});
    scene.camera = {.position = {-0.1f, -0.6f, -0.4f}, .target = {0, 0, -0.8f}, .up = {0, 0, 1}, .vertical_fov = 0.05f};
    double irradiance = 0;
    for (const uint32_t triangle : {2, 3}) {
        std::vector<dvec3> corners;
        for (int i = 0; i < 3; ++i) corners.emplace_back(scene.corner(triangle, i));
        irradiance += polygon_irradiance(corners, {0, 0, -0.8}, {0, 0, 1});
    }
    Scene dark = scene;
    dark.materials[2] = dark.materials[1];
    for (const std::string choice : {"CHOOSES_BY_TREE", "CHOOSES_BY_POWER", "CHOOSES_UNIFORMLY"})
        for (const Strategy strategy : {Strategy::both, Strategy::light}) {
            RenderSettings settings{.width = 16,
                                    .height = 16,
                                    .samples = 64,
                                    .max_path_length = 1,
                                    .strategy = strategy,
                                    .backend = fastest_backend()};
            settings.estimator = chapter_estimator(chapter_named("many_lights"));
            settings.estimator.defines.push_back("LIGHT_CHOICE " + choice);
            const FilmImage film = render(scene, settings);
            EXPECT_EQ(film.invalid_samples(), 0) << choice;
            expect_mean(choice, estimate_mean(pixel_means(film, 0)), 0.8 * irradiance / std::numbers::pi, 0.03, 6);
            EXPECT_EQ(render(dark, settings).invalid_samples(), 0) << choice << ", without another lamp";
        }
}

const LightLeaf& leaf_of(const Scene& scene, const LightTree& tree, uint32_t instance, uint32_t triangle) {
    return tree.leaves[tree.places[triangle] + tree.places[scene.triangles.size() + instance]];
}

// Every trail leads to its leaf, which knows the triangle's area, and every child's power is that of its own children.
void expect_right_tree(const Scene& scene, const LightTable& table, const LightTree& tree) {
    double unit = 0;  // of powers, which are proportional to area times luminance
    for (uint32_t i = 0; i < table.triangles.size(); ++i) {
        const LightTriangle& light = table.triangles[i];
        const LightLeaf& leaf = leaf_of(scene, tree, light.instance, light.triangle);
        uint32_t child = 0, trail = leaf.trail;
        double power = 0;
        for (; child < IS_LIGHT_LEAF; trail >>= 2) {
            const LightNode& node = tree.nodes[child];
            const auto next = static_cast<int>(trail & 3);
            child = node.child[next], power = node.power[next];
        }
        ASSERT_EQ(child, IS_LIGHT_LEAF + i);
        const auto corner = [&](int k) { return world_corner(scene, light.instance, light.triangle, k); };
        const double area = 0.5 * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
        ASSERT_NEAR(leaf.area, area, 1e-6 * area);
        const double expected = area * get_luminance(scene.material_of(light.triangle).emission);
        if (i == 0) unit = power / expected;
        ASSERT_NEAR(power, unit * expected, 1e-6 * power);
    }
    for (const LightNode& node : tree.nodes)
        for (int i = 0; i < 4; ++i) {
            if (node.child[i] >= IS_LIGHT_LEAF) continue;
            const vec4 powers = tree.nodes[node.child[i]].power;
            ASSERT_NEAR(node.power[i], powers.x + powers.y + powers.z + powers.w, 1e-6 * node.power[i]);
        }
}

// Each is 4 times as far away, and emits as much. Cuts between bins alone would make a tree of more levels than a trail has bits.
Scene lamps_at_growing_distances() {
    std::vector<Material> materials;
    std::vector<Quad> quads;
    for (int i = -28; i < 30; ++i) {
        const float x = std::ldexp(1.0f, 2 * i);
        materials.push_back(diffuse_material(vec3(0), vec3(1 / (x * x))));
        quads.push_back({{x, 0, 0}, {0, 0.1f * x, 0}, {0, 0, 0.1f * x}, static_cast<uint32_t>(i + 28)});
    }
    return make_scene(materials, quads);
}

TEST(LightTree, TrailsLeadToLeaves) {
    for (const Scene& scene : {load_shipped_scene("lamps.json"), stretched_lamps(), lamps_at_growing_distances()}) {
        const LightTable table = build_light_table(scene);
        expect_right_tree(scene, table, build_light_tree(scene, table));
    }
}

// Rays may find either of two lamps in one place, and the table has only one of them.
TEST(LightTree, LampsInThePlaceOfOthersHaveTheirLeaves) {
    Scene scene = random_lamps(40, 3);
    place(scene, mat4x3(1));
    const LightTable table = build_light_table(scene);
    const LightTree tree = build_light_tree(scene, table);
    ASSERT_EQ(table.triangles.size(), 80u);
    ASSERT_EQ(tree.leaves.size(), 160u);
    for (const LightTriangle& light : table.triangles) {
        const LightLeaf &first = leaf_of(scene, tree, 0, light.triangle), &second = leaf_of(scene, tree, 1, light.triangle);
        EXPECT_EQ(first.trail, second.trail);
        EXPECT_EQ(first.area, second.area);
    }
}

// Of lamps one wide at these places. They face up, or every other one down.
LightNode root_of_lamps(const std::vector<vec3>& places, bool alternate = false, float radiance_of_last = 1) {
    std::vector<Quad> quads;
    for (const vec3& place : places) quads.push_back({place, {0, 0, 1}, {1, 0, 0}, 0});
    for (size_t i = 1; alternate && i < quads.size(); i += 2) std::swap(quads[i].edge_u, quads[i].edge_v);
    quads.back().material = 1;
    const Scene scene =
        make_scene({diffuse_material(vec3(0), vec3(1)), diffuse_material(vec3(0), vec3(radiance_of_last))}, quads);
    return build_light_tree(scene, build_light_table(scene)).nodes.front();
}

TEST(LightTree, CutsKeepNeighboursTogetherAndLampsThatFaceTheSameWay) {
    std::vector<vec3> groups, row, rows;
    for (int i = 0; i < 16; ++i) {
        groups.emplace_back(2 * i + (i < 4 ? 0 : 1000), 0, 0);
        row.emplace_back(2 * i, 0, 0);
        rows.emplace_back(i % 2 * 2 + i / 2 % 2, 0, 2.5f * static_cast<float>(i / 4));
    }
    const LightNode neighbours = root_of_lamps(groups), even = root_of_lamps(row), facing = root_of_lamps(rows, true),
                    bright = root_of_lamps(row, false, 1e3f);
    for (int i = 0; i < 4; ++i) {
        EXPECT_LT(neighbours.radius[i], 20);
        EXPECT_LT(even.radius[i], 4);
        EXPECT_NEAR(std::abs(facing.mean_normal_y[i]), 1, 1e-6);
        // Few others are beside the bright one.
        EXPECT_TRUE(bright.power[i] < 0.9f * glm::dot(bright.power, vec4(1)) || bright.radius[i] < 1.5f) << bright.radius[i];
    }
}

// From a point of a lamp's front the window finds the nodes on its trail, and none from behind.
TEST(LightTree, BranchesOfLightSamples) {
    for (const Scene& scene : {load_shipped_scene("lamps.json"), stretched_lamps()}) {
        const LightTable table = build_light_table(scene);
        const LightTree tree = build_light_tree(scene, table);
        const LightBranches branches(scene);
        for (const LightTriangle& light : table.triangles) {
            std::vector<Sphere> expected;
            vec3 normal;
            uint32_t trail = leaf_of(scene, tree, light.instance, light.triangle).trail;
            for (uint32_t node = 0; node < IS_LIGHT_LEAF; trail >>= 2) {
                const LightNode& parent = tree.nodes[node];
                const auto i = static_cast<int>(trail & 3);
                expected.push_back({{parent.centre_x[i], parent.centre_y[i], parent.centre_z[i]}, parent.radius[i]});
                normal = {parent.mean_normal_x[i], parent.mean_normal_y[i], parent.mean_normal_z[i]};
                node = parent.child[i];
            }
            vec3 point(0);
            for (int i = 0; i < 3; ++i)
                point += (i == 0 ? 0.7f : 0.15f) * vec3(world_corner(scene, light.instance, light.triangle, i));
            const std::vector<Sphere> found = branches.find(point + normal, point);
            ASSERT_EQ(found.size(), expected.size());
            for (size_t i = 0; i < found.size(); ++i) {
                ASSERT_EQ(found[i].centre, expected[i].centre);
                ASSERT_EQ(found[i].radius, expected[i].radius);
            }
            for (const Sphere& sphere : branches.find(point - normal, point)) ASSERT_NE(sphere.radius, expected.back().radius);
        }
    }
}

TEST(LightTree, AMillionLampsOfTwelveDecades) {
    const Scene scene = random_lamps(500'000, 12);
    const LightTable table = build_light_table(scene);
    const auto start = std::chrono::steady_clock::now();
    const LightTree tree = build_light_tree(scene, table);
    std::printf("  built in %.2f s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    expect_right_tree(scene, table, tree);
}

}  // namespace
}  // namespace lab
