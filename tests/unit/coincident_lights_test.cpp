// Coincident triangles, at least one of which emits: which ones are dropped, paired or warned about.
#include "scene/light_table.h"
#include "scene/scene.h"
#include "test_files.h"

namespace lab {
namespace {

const std::string corners = "v 0 0 0\nv 1 0 0\nv -0 1 0\nv 0 -0 0\n";  // the last equals the first

class CoincidentLights : public testing::Test {
  protected:
    CoincidentLights() {
        folder.write("a.mtl",
                     "newmtl lamp\nKe 1 1 1\nnewmtl bright\nKe 5 5 5\nnewmtl wall\nKd 1 1 1\n"
                     "newmtl glass\nd 0\nNi 1.5\n");
    }

    // A mesh with these faces, all using the same triangle.
    std::filesystem::path mesh(const std::string& name, const std::string& faces) const {
        return folder.write(name, "mtllib a.mtl\n" + corners + faces);
    }

    // Meshes placed side by side in one scene.
    Scene load(const std::string& entries) const { return load_scene(folder.write("a.json", "{\"meshes\": [" + entries + "]}")); }

    TestFolder folder;
};

TEST_F(CoincidentLights, ThatFaceTheSameWayAreTheFirst) {
    const Scene scene =
        load_scene(mesh("a.obj", "usemtl wall\nf 1 2 3\nusemtl lamp\nf 2 3 4\nusemtl bright\nf 3 1 2\nf 1 2 3\n"));
    ASSERT_EQ(scene.triangles.size(), 1u);
    EXPECT_EQ(scene.materials.at(scene.triangle_materials.at(0)).emission, vec3(1));
    EXPECT_EQ(scene.meshes.at(0).triangle_count, 1u);
    EXPECT_TRUE(scene.double_sided.empty());
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_PRED_FORMAT2(testing::IsSubstring,
                        "a.obj:7: lies in the same place as line 9, faces the same way, and one of them emits: "
                        "left out, as 2 others",
                        scene.warnings[0]);
}

TEST_F(CoincidentLights, ThatFaceOppositeWaysAreTwoSides) {
    const Scene scene = load_scene(mesh("a.obj",
                                        "v 5 5 1\nusemtl wall\nf 1 2 5\nf 1 2 3\nusemtl wall\nf 1 2 3\n"
                                        "usemtl lamp\nf 1 2 3\nusemtl bright\nf 3 2 4\n"));
    EXPECT_EQ(scene.warnings.size(), 1u);
    ASSERT_EQ(scene.triangles.size(), 3u);
    ASSERT_EQ(scene.double_sided.size(), 1u);
    const uvec2 sides = scene.double_sided[0];
    EXPECT_EQ(sides.x + sides.y, 3u);
    const uvec3 a = scene.triangles[sides.x], b = scene.triangles[sides.y];
    for (const auto& [i, k] : {std::pair{0, 0}, {1, 2}, {2, 1}}) EXPECT_EQ(scene.positions[a[i]], scene.positions[b[k]]);
    EXPECT_EQ(build_light_table(scene).triangles.size(), 2u);
}

TEST_F(CoincidentLights, AreNotThoseElsewhereOrThatDoNotEmit) {
    const Scene scene = load_scene(mesh("a.obj",
                                        "v 0 0 1\nusemtl lamp\nf 1 2 3\nusemtl wall\nf 1 2 5\nf 1 2 5\n"
                                        "f 2 1 5\n"));
    EXPECT_EQ(scene.triangles.size(), 4u);
    EXPECT_TRUE(scene.double_sided.empty());
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(CoincidentLights, OfDifferentInstancesAreNamed) {
    mesh("lamp.obj", "usemtl lamp\nf 1 2 3\n");
    mesh("bright.obj", "usemtl bright\nf 1 2 3\n");
    mesh("wall.obj", "usemtl wall\nf 1 2 3\n");
    const std::string lamp = R"({"file": "lamp.obj"})", bright = R"({"file": "bright.obj"})", wall = R"({"file": "wall.obj"})",
                      mirrored = R"({"file": "lamp.obj", "scale": [1, 1, -1]})",
                      elsewhere = R"({"file": "bright.obj", "translation": [0, 0, 1]})";
    const auto warnings = load(lamp + "," + elsewhere + "," + bright).warnings;
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "bright.obj: lies in the plane of", warnings[0]);
    for (const std::string& other : {wall, mirrored})
        EXPECT_TRUE(load(lamp + "," + elsewhere + "," + other).warnings.empty()) << "each is seen from its front";
    EXPECT_EQ(build_light_table(load(lamp + "," + mirrored)).triangles.size(), 2u) << "they face opposite ways";
}

}  // namespace
}  // namespace lab
