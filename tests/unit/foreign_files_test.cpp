// OBJ and MTL files as other programs write them, and as they go wrong on the way.
#include "mesh_fixture.h"

namespace lab {
namespace {

using testing::IsSubstring;

const std::string red = "newmtl red\nKd 0.75 0.25 0.25\n", blue = "newmtl blue\nKd 0.25 0.25 0.75\n";

class ForeignFiles : public MeshFile {
  protected:
    // The materials of the triangles, in one letter each: red, blue or grey.
    std::string colours(const std::string& obj) const {
        const Scene scene = load(obj);
        std::string letters;
        for (const uint32_t material : scene.triangle_materials) {
            const vec3 albedo = scene.materials.at(material).diffuse_albedo;
            letters += albedo == vec3(0.5f) ? 'g' : albedo.x > albedo.z ? 'r' : 'b';
        }
        return letters;
    }
};

TEST_F(ForeignFiles, CornersMayEndInSlashes) {
    const std::string arrays = corners_of_a_square + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 1 0 0\nvn 0 0 1\nvn 0 1 1\nvn 0 1 0\n";
    folder.write("a.mtl", red + "map_Kd a.png\n");
    write_png(folder / "a.png", {1, 1, {255, 255, 255, 255}});
    const std::string start = "mtllib a.mtl\nusemtl red\n" + arrays;
    for (const auto& [written, meant] : {std::pair{"f 1// 2// 3// 4//\n", "f 1 2 3 4\n"},
                                         {"f 1/ 2/ 3/ 4/\n", "f 1 2 3 4\n"},
                                         {"f 1/1/ 2/2/ 3/3/ 4/4/", "f 1/1 2/2 3/3 4/4"},
                                         {"f -4/-4/ -3/1/\t-2//2 -1//\n", "f 1/1 2/1 3//2 4\n"}}) {
        const Scene scene = load(start + written), expected = load(start + meant);
        EXPECT_EQ(scene.positions, expected.positions) << written;
        EXPECT_EQ(scene.normals, expected.normals) << written;
        EXPECT_EQ(scene.texture_coordinates, expected.texture_coordinates) << written;
        EXPECT_EQ(scene.triangles, expected.triangles) << written;
    }
}

TEST_F(ForeignFiles, CornersAreThreeIndicesAtMost) {
    for (const char* face : {"f 1//2//3 2 3", "f 1/1/1/1 2 3", "f /1 2 3", "f // 2 3", "f 1-2 2 3", "f 1 2 3 +4", "f 1 2 - 3"})
        EXPECT_USER_ERROR(load(corners_of_a_square + "vt 0 0\nvn 0 0 1\nvn 0 0 1\n" + face + "\n"), "a.obj:8: ") << face;
}

TEST_F(ForeignFiles, CommentsMayFollowAnyStatement) {
    folder.write("a.mtl", "newmtl red # the colour\nKd 0.75 0.25 0.25 # linear\nmap_Kd a.png # white\nd 1# opaque\n");
    write_png(folder / "a.png", {1, 1, {255, 255, 255, 255}});
    EXPECT_EQ(colours("mtllib a.mtl # library\nusemtl red # or not\nv 0 0 0# origin\nv 1 0 0 # x\nv 0 1 0.#y\n"
                      "f 1 2 3 # the front\nf 3 2 1# the back\nusemtl # none\nf 1 2 3 #\n"),
              "rrg");
}

TEST_F(ForeignFiles, ByteOrderMarksAreSkipped) {
    const std::string mark = "\xef\xbb\xbf";
    folder.write("a.mtl", mark + red);
    EXPECT_EQ(colours(mark + "mtllib a.mtl\nusemtl red\n" + corners_of_a_square + "f 1 2 3\n"), "r");
    // Also where files were joined.
    EXPECT_EQ(load(mark + "v 0 0 0\nv 1 0 0\n" + mark + "v 0 1 0\nf 1 2 3\n").triangles.size(), 1u);
}

TEST_F(ForeignFiles, LinesMayBeJoined) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string obj =
            "mtllib \\\na.mtl\nusemtl\\\n red\n# not joined \\\nv 0 0\\\n 0\nv 1 \\\t\n0 \\\n0\nv 0 1 0\nf 1 2 \\\n3 \\";
        for (size_t i = obj.find('\n'); i != obj.npos; i = obj.find('\n', i + end.size())) obj.replace(i, 1, end);
        folder.write("a.mtl", "newmtl \\" + end + "red" + end + "Kd 0.75 \\ # r" + end + "\t0.25 0.25" + end);
        EXPECT_EQ(colours(obj), "r") << obj;
    }
    // Errors name the line on which the statement starts.
    EXPECT_USER_ERROR(load("v 0 0 \\\n0\nv 1 0 0\nv 0 \\\n1 \\\n0\n\nf 1 2 \\\n4\n"), "a.obj:8: the face refers to vertex 4");
    EXPECT_USER_ERROR(load_material("Kd 1 \\\n1 1\nKe 1 \\\n1 \\\nx\n"), "a.mtl:4: Ke \"x\"");
}

TEST_F(ForeignFiles, NulsMayFollowTheLastLine) {
    for (const std::string& end : {std::string(1, '\0'), std::string(700, '\0'), std::string("\0\r\n", 3), std::string("\x1a")}) {
        folder.write("a.mtl", red + end);
        EXPECT_EQ(colours("mtllib a.mtl\nusemtl red\n" + corners_of_a_square + "f 1 2 3\n" + end), "r");
    }
}

TEST_F(ForeignFiles, FacesBehindUsemtlWithoutANameAreGrey) {
    folder.write("a.mtl", red);
    for (const char* line : {"usemtl", "usemtl ", "usemtl\t", "usemtl \"\""}) {
        const std::string obj = "mtllib a.mtl\n" + corners_of_a_square + "usemtl red\nf 1 2 3\n" + line + "\nf 1 3 4\n";
        EXPECT_EQ(colours(obj), "rg") << line;
        EXPECT_EQ(count_warnings(load(obj), "a.obj:8: usemtl needs a name: 1 faces"), 1u) << line;
    }
}

TEST_F(ForeignFiles, OptionsOfTexturesMayLeaveNumbersOut) {
    write_png(folder / "a.png", {1, 1, {9, 9, 9, 255}});
    write_png(folder / "a 2.png", {1, 1, {9, 9, 9, 255}});
    for (const char* options : {"-s 2", "-s 2 1", "-s 2 2 2", "-o 0.5", "-t .1 -o 1 1", "-cc on", "-clamp off -mm 0 1", "-mm 0.1",
                                "-blendu on -blendv off", "-texres 512", "-bm 1", "-boost 2.5", "-imfchan r", "-type sphere",
                                "-colorspace sRGB", "-o 0.0 -7.0 0.0 -s 1.0 10.0 1.0 -clamp on"})
        for (const char* name : {"a.png", "a 2.png", "\"a 2.png\"", ".\\a.png"})
            for (const bool is_before : {true, false}) {
                const std::string value = is_before ? std::string(options) + " " + name : std::string(name) + " " + options;
                const Scene scene = load_material("map_Kd " + value);
                EXPECT_EQ(scene.textures.size(), 1u) << value;
                EXPECT_EQ(scene.materials.at(0).diffuse_albedo, vec3(1)) << value;
                EXPECT_EQ(count_warnings(scene, "without effect here: options of map_Kd"), 1u) << value;
            }
    const Scene nameless = load_material("map_Kd -s 2");
    EXPECT_EQ(nameless.materials.at(0).diffuse_albedo, vec3(0));
    EXPECT_EQ(count_warnings(nameless, "map_Kd without a name"), 1u);
}

TEST_F(ForeignFiles, NumbersThatMicrosoftWritesAreRefused) {
    for (const std::string number : {"1.#QNAN", "-1.#IND", "1.#INF", "-1.#IND00", "1.#QNAN0", "1.#J", "-nan(ind)"}) {
        const std::string quoted = "\"" + number + "\"";
        for (const std::string line : {"v 0 0 ", "vn 0 1 ", "vt ", "vt 0 ", "v 0 0 0 1 1 "})
            EXPECT_USER_ERROR(load(corners_of_a_square + line + number + "\nf 1 2 3\n"), "a.obj:5: " + quoted) << line;
        for (const std::string line : {"Kd 1 1 ", "Ke ", "Ks 1 ", "Tf ", "Kt ", "Ns ", "Ni ", "d ", "Tr ", "Pr ", "Pm "})
            EXPECT_USER_ERROR(load_material(line + number + " 1 1"), quoted) << line;
        if (number.find('#') == number.npos) continue;
        for (const std::string line : {"vp ", "f 1 2 ", "l 1 "})
            EXPECT_USER_ERROR(load(corners_of_a_square + line + number + "\nf 1 2 3\n"), "a.obj:5: " + quoted) << line;
        for (const std::string line : {"Ka 1 1 ", "Ps ", "illum ", "sharpness "})
            EXPECT_USER_ERROR(load_material(line + number), "a.mtl:2: " + quoted) << line;
    }
}

TEST_F(ForeignFiles, TheSmallestNumbersAreZero) {
    for (const char* number : {"1e-400", "-1e-400", "0.1e-99999999999", "1e-46", "0e999"})
        EXPECT_EQ(load("v 0 0 " + std::string(number) + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").positions.at(0), vec3(0)) << number;
    for (const char* number : {"1e400", "-1e400", "1e99999999999", "+-1", "--1", "0x1", "1,5", "1.0D+00", "1e", "."})
        EXPECT_USER_ERROR(load("v 0 0 " + std::string(number) + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "a.obj:1: ") << number;
}

TEST_F(ForeignFiles, SeveralMaterialFilesMayShareALine) {
    folder.write("one.mtl", red);
    folder.write("two.mtl", blue + "newmtl red\nKd 0 0 1\n");
    folder.write("three words.mtl", red);
    const std::string faces = corners_of_a_square + "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n";
    for (const char* names : {"one.mtl two.mtl", "one.mtl\ttwo.mtl", "\"one.mtl\" \"two.mtl\"", "one.mtl missing.mtl two.mtl",
                              "\"three words.mtl\" two.mtl"})
        EXPECT_EQ(colours("mtllib " + std::string(names) + "\n" + faces), "rb") << names;
}

TEST_F(ForeignFiles, NamesMayBeInQuotesAndPathsOfWindows) {
    folder.write("lib/red paint.mtl", red);
    for (const std::string name : {"\"lib/red paint.mtl\"", "lib\\red paint.mtl", ".\\lib\\red paint.mtl", "lib/red\\ paint.mtl"})
        for (const std::string material : {"red", "\"red\""}) {
            const Scene scene = load("mtllib " + name + "\nusemtl " + material + "\n" + corners_of_a_square + "f 1 2 3\n");
            EXPECT_EQ(scene.materials.at(0).diffuse_albedo, vec3(0.75f, 0.25f, 0.25f)) << name;
        }
    folder.write("lib/red paint.mtl", "newmtl \"red\"\nKd 0.75 0.25 0.25\n");
    EXPECT_EQ(colours("mtllib lib/red paint.mtl\nusemtl red\n" + corners_of_a_square + "f 1 2 3\n"), "r");
    // A note has the name as it is in the file.
    const Scene missing = load("mtllib .\\lib\\blue.mtl\n" + corners_of_a_square + "f 1 2 3\n");
    EXPECT_EQ(count_warnings(missing, "a.obj:1: there is no material file \".\\lib\\blue.mtl\""), 1u);
}

TEST_F(ForeignFiles, AFolderMayHaveTheNameOfAWord) {
    std::filesystem::create_directory(folder / "tree");
    for (const std::string name : {"tree v2.mtl", "a tree", ""}) {
        const Scene scene = load("mtllib " + name + "\n" + corners_of_a_square + "f 1 2 3\n");
        EXPECT_EQ(count_warnings(scene, "a.obj:1: there is no material file \"" + name + "\": 1 faces"), 1u) << name;
    }
}

TEST_F(ForeignFiles, MaterialFilesMayFollowTheirUse) {
    folder.write("a.mtl", red);
    folder.write("b.mtl", blue + "newmtl red\nKd 0 0 1\n");
    EXPECT_EQ(colours(corners_of_a_square + "usemtl red\nf 1 2 3\nmtllib a.mtl\nusemtl blue\nf 1 3 4\nmtllib b.mtl\n"), "rb");
    const Scene grey =
        load(corners_of_a_square + "f 1 2 3\nusemtl none\nf 1 2 4\nusemtl red\nf 1 3 4\nmtllib c.mtl\nmtllib a.mtl\n");
    EXPECT_EQ(count_warnings(grey, "a.obj:6: there is no material \"none\": 2 faces"), 1u) << "the first one in the file";
}

TEST_F(ForeignFiles, WhatMakesAModelVanishIsNoted) {
    const std::string note = "material \"m\": is transparent (d < 1 or Tr > 0), and with Ni 1 it is invisible";
    for (const char* lines : {"Tr 1", "Tr 1\nNi 1", "d 0.3", "d 0.3\nTf 1 1 1"})
        EXPECT_EQ(count_warnings(load_material(lines), note), 1u) << lines;
    for (const char* lines : {"Tr 1\nd 1", "Tr 1\nNi 1.5", "d 0.3\nTf 0.5 1 1", "Tr 0", "d 1"})
        EXPECT_EQ(count_warnings(load_material(lines), "invisible"), 0u) << lines;
    write_png(folder / "a.png", {1, 1, {9, 9, 9, 255}});
    EXPECT_EQ(count_warnings(load_material("Kd 0 0 0\nmap_Kd a.png"), "material \"m\": Kd 0 makes map_Kd black"), 1u);
    EXPECT_EQ(count_warnings(load_material("Kd 0 0 0.1\nmap_Kd a.png"), "black"), 0u);
}

TEST_F(ForeignFiles, ColoursAndWeightsOfVerticesAreNoted) {
    const auto notes = [&](const std::string& behind) {
        return count_warnings(load("v 0 0 0" + behind + "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "without effect here");
    };
    for (const char* behind : {" 1 0.5 0.5", " 1 0.5 0.5 1", " 2", " 0"}) EXPECT_EQ(notes(behind), 1u) << behind;
    for (const char* behind : {"", " 1", " 1.0"}) EXPECT_EQ(notes(behind), 0u) << behind;
}

TEST_F(ForeignFiles, MetalsHaveAnyRefractiveIndex) {
    for (const char* index : {"0", "0.18", "0.47", "1", "200"})
        EXPECT_EQ(load_material("Kd 1 0.8 0.3\nPr 0.2\nPm 1\nNi " + std::string(index)).microfacets.at(0).coat_index, 1.5f)
            << index;
    EXPECT_USER_ERROR(load_material("Pr 0.2\nPm 0.5\nNi 0.5"), "has a coat (Pr) and needs a refractive index");
}

TEST_F(ForeignFiles, AKeyOfASceneStandsOnlyOnce) {
    folder.write("a.obj", corners_of_a_square + "f 1 2 3\n");
    const auto read = [&](const std::string& keys) {
        load_scene(folder.write("a.json", R"({"meshes": [{"file": "a.obj")" + keys + "}"));
    };
    EXPECT_USER_ERROR(read(R"(}], "width": 8, "width": 8)"), "a.json: the key \"width\" stands twice");
    EXPECT_USER_ERROR(read(R"(, "file": "a.obj"}])"), "\"file\" stands twice");
    EXPECT_NO_THROW(read(R"(}, {"file": "a.obj"}])"));
}

}  // namespace
}  // namespace lab
