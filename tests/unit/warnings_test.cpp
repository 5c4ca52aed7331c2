// What the loader warns about: dielectrics that suggest more than is computed, and scenes that exceed the precision of 32 bits.
#include "scene/warnings.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "files/project_folder.h"
#include "scene/scene.h"
#include "test_files.h"

namespace lab {
namespace {

const std::string nested = "a dielectric may lie inside the dielectric of ",
                  enclosed = "an opaque object may lie inside the absorbing glass of ";

// A folder with a cube [-1,1]³ of each material, cube_<material>.obj.
class DielectricWarnings : public testing::Test {
  protected:
    DielectricWarnings() {
        folder.write("all.mtl",
                     "newmtl clear\nd 0\nNi 1.5\nnewmtl teal\nd 0\nNi 1.5\nTf 0.1 0.5 0.6\nnewmtl wall\nKd 1 1 1\n"
                     "newmtl water\nd 0\nNi 1.33\n");
        for (const std::string material : {"clear", "teal", "wall"})
            folder.write("cube_" + material + ".obj", "mtllib all.mtl\nusemtl " + material + "\n" + cube(1));
    }

    // The faces of a cube of 8 more vertices.
    static std::string cube(int half_width) {
        const std::string one = std::to_string(half_width);
        std::string text;
        for (int corner = 0; corner < 8; ++corner) {
            text += "v";
            for (int axis = 0; axis < 3; ++axis) text += (corner >> axis & 1 ? " " : " -") + one;
            text += "\n";
        }
        return text + "f -8 -6 -5 -7\nf -4 -3 -1 -2\nf -8 -7 -3 -4\nf -6 -2 -1 -5\nf -8 -4 -2 -6\nf -7 -5 -1 -3\n";
    }

    // Warnings for these entries of "meshes".
    std::vector<std::string> warnings(const std::string& meshes) const {
        return load_scene(folder.write("a.json", R"({"meshes": [)" + meshes + "]}")).warnings;
    }

    // An entry of "meshes".
    static std::string entry(const std::string& material, double scale, double x = 0) {
        return R"({"file": "cube_)" + material + R"(.obj", "scale": )" + std::to_string(scale) + R"(, "translation": [)" +
               std::to_string(x) + ", 0, 0]}";
    }

    // Expects a single warning, of this kind, that names these files.
    static void expect_only(const std::vector<std::string>& warnings, const std::string& kind, const std::string& inner,
                            const std::string& outer) {
        ASSERT_EQ(warnings.size(), 1u) << kind;
        EXPECT_NE(warnings[0].find("cube_" + inner + ".obj: " + kind), std::string::npos) << warnings[0];
        EXPECT_NE(warnings[0].find("cube_" + outer + ".obj: ", warnings[0].find(" of ")), std::string::npos) << warnings[0];
        EXPECT_EQ(warnings[0].find('\n'), std::string::npos);
    }

    TestFolder folder;
};

TEST_F(DielectricWarnings, NameADielectricInsideAnother) {
    expect_only(warnings(entry("clear", 2) + "," + entry("teal", 1)), nested, "teal", "clear");
    expect_only(warnings(entry("clear", 1) + "," + entry("clear", 3)), nested, "clear", "clear");
    expect_only(warnings(entry("clear", 1, 0.5) + "," + entry("teal", 2)), nested, "clear", "teal");
}

TEST_F(DielectricWarnings, NameAnOpaqueObjectInsideAbsorbingGlass) {
    expect_only(warnings(entry("teal", 2) + "," + entry("wall", 1)), enclosed, "wall", "teal");
}

TEST_F(DielectricWarnings, NameGlassThatIsNotClosed) {
    const auto load = [&](const std::string& text) {
        return load_scene(folder.write("sheet.obj", "mtllib all.mtl\nusemtl clear\n" + text)).warnings;
    };
    const auto count = [&](const std::string& text) {
        const auto found = load(text);
        if (found.size() == 1) return std::string("none");  // the white sky
        EXPECT_EQ(found.size(), 2u);
        const std::string part = "sheet.obj: its glass is not closed: ";
        const size_t begin = found[1].find(part);
        EXPECT_NE(begin, std::string::npos) << found[1];
        return found[1].substr(begin + part.size(), found[1].find(" edges") - begin - part.size());
    };
    EXPECT_EQ(count("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"), "4");
    const std::string closed = cube(1);
    EXPECT_EQ(count(closed), "none");
    EXPECT_EQ(count(closed.substr(0, closed.rfind("f "))), "4") << "a box without its lid";
    EXPECT_EQ(count(closed.substr(0, closed.rfind("f ")) + "f -7 -3 -1 -5\n"), "4") << "its lid inside out";
    EXPECT_EQ(count(closed.substr(0, closed.rfind("f ")) + "usemtl wall\nf -7 -5 -1 -3\n"), "4") << "of wood";
    // Each face with its own corners, and -0 equals 0.
    EXPECT_EQ(count("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv -0 0 0\nf 1 3 2\nf 5 2 4\nf 2 3 4\nf 1 4 3\n"), "none");
}

TEST_F(DielectricWarnings, AreOneLineForEachKind) {
    std::string meshes = entry("teal", 50);
    for (int i = -8; i <= 8; ++i) meshes += "," + entry("clear", 1, 3 * i) + "," + entry("wall", 0.5, 3 * i);
    EXPECT_EQ(warnings(meshes).size(), 2u);
}

TEST_F(DielectricWarnings, TellMaterialsOfOneMeshApart) {
    folder.write("drink.obj", "mtllib all.mtl\nusemtl clear\n" + cube(2) + "usemtl water\n" + cube(1));
    const auto found = warnings(R"({"file": "drink.obj"})");
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].find("drink.obj: " + nested), std::string::npos) << found[0];
}

TEST_F(DielectricWarnings, AreNotForWhatIsComputed) {
    const std::string right_scenes[] = {
        entry("clear", 2) + "," + entry("wall", 1),       // opaque in clear glass
        entry("wall", 5) + "," + entry("teal", 1),        // glass in a room
        entry("teal", 1) + "," + entry("clear", 1, 3),    // side by side
        entry("teal", 2) + "," + entry("clear", 1, 1.5),  // partly inside
        entry("wall", 2) + "," + entry("wall", 1),        // no glass at all
        entry("teal", 1) + "," + entry("wall", 1, 2),     // touching
        entry("clear", 1) + "," + entry("wall", 1, 1.5),  // reaching into clear glass
    };
    for (const std::string& scene : right_scenes) EXPECT_TRUE(warnings(scene).empty()) << scene;
}

TEST_F(DielectricWarnings, AreNotForTheGlassScene) {
    EXPECT_TRUE(load_scene(project_folder() / "assets/scenes/glass.json").warnings.empty());
}

TEST_F(DielectricWarnings, EndEarlyInScenesOfManyInstances) {
    std::string meshes = entry("clear", 1);
    for (int i = 1; i < 5000; ++i) meshes += "," + entry("clear", 1, i);
    EXPECT_TRUE(warnings(meshes).empty());
}

TEST_F(DielectricWarnings, AbsurdIndicesAreRefused) {
    const auto load = [&](const std::string& index) {
        folder.write("b.mtl", "newmtl m\nd 0\nNi " + index + "\n");
        return load_scene(folder.write("b.obj", "mtllib b.mtl\nusemtl m\n" + cube(1)));
    };
    for (const char* index : {"-1.5", "0", "-0", "nan", "inf", "1e39", "1e-30", "1e30"}) EXPECT_USER_ERROR(load(index), "Ni");
    for (const char* index : {"1", "0.75", "2.42", "4"}) EXPECT_NO_THROW(load(index)) << index;
}

class PrecisionWarnings : public testing::Test {
  protected:
    // The warnings of a scene file with a tetrahedron of size 1 and these keys.
    std::vector<std::string> warnings(const std::string& placement, const std::string& keys = "") const {
        folder_.write("a.mtl", "newmtl m\nKd 1 1 1\nKe 1 1 1\n");
        folder_.write("a.obj",
                      "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                      "f 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n");
        return load_scene(folder_.write("s.json", R"({"meshes": [{"file": "a.obj")" + placement + "}]" + keys + "}")).warnings;
    }

  private:
    TestFolder folder_;
};

TEST_F(PrecisionWarnings, TellHowFarFromTheOriginASceneIs) {
    EXPECT_TRUE(warnings("").empty());
    EXPECT_TRUE(warnings(R"(, "translation": [1000, 1000, 0])").empty());
    // 8 · 2^-24 (20000 + 1) relative to the diagonal √3.
    const auto far = warnings(R"(, "translation": [20000, 0, 0])");
    ASSERT_EQ(far.size(), 1u);
    EXPECT_NE(far.front().find("blur 0.55 % of its size"), std::string::npos) << far.front();
    EXPECT_NE(far.front().find("s.json"), std::string::npos);
    // What counts is the distance relative to the size.
    EXPECT_TRUE(warnings(R"(, "scale": 1000, "translation": [20000, 0, 0])").empty());
    EXPECT_EQ(warnings(R"(, "scale": 1e-5, "translation": [1, 0, 0])").size(), 1u);
}

TEST_F(PrecisionWarnings, TellHowNarrowAFieldOfViewIs) {
    const auto with_fov = [&](const std::string& degrees, int height) {
        return warnings("", R"(, "height": )" + std::to_string(height) +
                                R"(, "camera": {"position": [0, 0, 5], "target": [0, 0, 0], "vertical_fov": )" + degrees + "}");
    };
    EXPECT_TRUE(with_fov("0.1", 512).empty());
    EXPECT_TRUE(with_fov("0.0001", 1).empty());
    const auto narrow = with_fov("0.001", 512);
    ASSERT_EQ(narrow.size(), 1u);
    EXPECT_NE(narrow.front().find("rounded to 1.7 of a pixel"), std::string::npos) << narrow.front();
}

// A lamp above a floor, between them the camera.
TEST(LampWarnings, TellThatAllLampsFaceAway) {
    const TestFolder folder;
    folder.write("a.mtl", "newmtl lamp\nKe 1 1 1\nnewmtl floor\nKd 0.5 0.5 0.5\n");
    const auto warnings = [&](const std::string& faces, const std::string& scale = "1") {
        folder.write(
            "a.obj",
            "mtllib a.mtl\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\nv -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2\nusemtl floor\n"
            "f 5 6 7 8\nusemtl lamp\n" +
                faces);
        return load_scene(folder.write("a.json", R"({"meshes": [{"file": "a.obj", "scale": )" + scale +
                                                     R"(}], "camera": {"position": [0, 1, 6], "target": [0, 1, 0]}})"))
            .warnings;
    };
    EXPECT_TRUE(warnings("f 1 2 3 4\n").empty());
    EXPECT_TRUE(warnings("f 1 2 3 4\n", "[-1, 1, 1]").empty());
    EXPECT_TRUE(warnings("f 1 2 3\nf 4 3 1\n").empty());
    for (const char* scale : {"1", "[1, 1, -1]"}) {
        const auto away = warnings("f 4 3 2 1\n", scale);
        ASSERT_EQ(away.size(), 1u);
        EXPECT_NE(away.front().find("a.json: its lamps face away"), std::string::npos) << away.front();
    }
}

}  // namespace
}  // namespace lab
