// OBJ files: what each keyword means, and what the loader refuses.
#include <algorithm>
#include <array>
#include <cmath>

#include "mesh_fixture.h"
#include "scene/triangulate.h"

namespace lab {
namespace {

using testing::IsSubstring;

vec3 face_normal(const Scene& scene, size_t triangle) {
    const uvec3 corners = scene.triangles.at(triangle);
    const vec3 origin = scene.positions.at(corners.x);
    return glm::normalize(glm::cross(scene.positions.at(corners.y) - origin, scene.positions.at(corners.z) - origin));
}

double total_area(const std::vector<vec3>& polygon) {
    double area = 0;
    for (const auto& [a, b, c] : triangulate(polygon)) {
        const vec3 cross = glm::cross(polygon[b] - polygon[a], polygon[c] - polygon[a]);
        EXPECT_GE(cross.z, -1e-6f) << "a triangle lies outside the polygon";
        area += 0.5 * glm::length(cross);
    }
    return area;
}

TEST(Triangulate, ConvexPolygonsAreFans) {
    const std::vector<vec3> square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const std::vector<std::array<uint32_t, 3>> fan = {{0, 1, 2}, {0, 2, 3}};
    EXPECT_EQ(triangulate(square), fan);
}

TEST(Triangulate, ConcavePolygonsAreCovered) {
    const std::vector<vec3> arrow = {{0, 0, 0}, {1, 0.2f, 0}, {2, 0, 0}, {1, 2, 0}};
    EXPECT_NEAR(total_area(arrow), 1.8, 1e-6);
    std::vector<vec3> star, comb;
    for (int i = 0; i < 20; ++i) {
        const double angle = i * std::acos(-1) / 10, radius = i % 2 ? 1 : 3;
        star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    }
    EXPECT_NEAR(total_area(star), 10 * 1 * 3 * std::sin(std::acos(-1) / 10), 1e-5);
    for (int i = 0; i <= 40; ++i) comb.emplace_back(i, i % 2 ? 1 : 9, 0);
    comb.emplace_back(40, 0, 0);
    comb.emplace_back(0, 0, 0);
    std::reverse(comb.begin(), comb.end());
    EXPECT_NEAR(total_area(comb), 40 * 5, 1e-4);
}

TEST(Triangulate, PolygonsThatAreNoneStillEnd) {
    const std::vector<vec3> point(256, vec3(1)), bow_tie = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_EQ(triangulate(point).size(), 254u);
    EXPECT_EQ(triangulate(bow_tie).size(), 2u);
}

TEST_F(MeshFile, EqualCornersShareAVertex) {
    const Scene scene = load(corners_of_a_square + "v 0 0 1\nf 1 2 3 4\nf -5 -4 -1\n");
    EXPECT_EQ(scene.positions.size(), 5u);
    EXPECT_EQ(scene.triangles, (std::vector<uvec3>{{0, 1, 2}, {0, 2, 3}, {0, 1, 4}}));
    EXPECT_TRUE(scene.normals.empty());
    EXPECT_TRUE(scene.texture_coordinates.empty());
    EXPECT_EQ(scene.meshes.at(0).triangle_count, 3u);
}

TEST_F(MeshFile, TextMayComeFromAnySystem) {
    const Scene scene = load("# comment\r\n\tv 0 0 0\r\nv  1\t0 0 # corner\r\nv 0 +1e0 0\r\n\r\ng x\r\ns off\r\nf 1 2 3");
    EXPECT_EQ(scene.triangles.size(), 1u);
    EXPECT_EQ(scene.positions.at(2), vec3(0, 1, 0));
}

// What ZBrush, Rhino, Wings 3D and editors on Windows write.
TEST_F(MeshFile, TextMayHaveMarksCommentsAndJoinedLines) {
    const std::string square = corners_of_a_square + "vn 0 0 1\nvn 1 0 1\nvt 0 0\n";
    const Scene plain = load(square + "f 1 2 3 4\n");
    for (const std::string face : {"f 1// 2// 3// 4//", "f 1/ 2/ 3/ 4/ ", "f 1 2 3 4 # the front", "f 1 2 3 4#2",
                                   "\tf 1 2 \\\n  3\\\r\n 4", "f 1 2 3 4\n# end\n\\"}) {
        const Scene scene = load("\xEF\xBB\xBF" + square + face + std::string("\n\0\0\n", 4));
        EXPECT_EQ(scene.positions, plain.positions) << face;
        EXPECT_EQ(scene.triangles, plain.triangles) << face;
        EXPECT_TRUE(scene.normals.empty()) << face;
    }
    EXPECT_EQ(load(square + "f 1//2 2//2 3//\n").normals, load(square + "f 1//2 2//2 3\n").normals);
    EXPECT_USER_ERROR(load("v 0 0 0\n\n" + square + "f 1 2 \\\n 9\n"), "a.obj:10: the face refers to vertex 9");
    EXPECT_USER_ERROR(load(square + "f \\\n # none\n"), "a.obj:8: a face needs at least 3 corners");
    EXPECT_USER_ERROR(load("v 0 0 -1.#IND\n"), "a.obj:1: \"-1.#IND\" is not a finite number");
    EXPECT_USER_ERROR(load_material("Kd 1 1 1.#QNAN0"), "a.mtl:2: \"1.#QNAN0\" is not a finite number");
    folder.write("a.mtl", "\xEF\xBB\xBFnewmtl m # red\nKd 1 \\\n 0 0\n" + std::string("\0", 1));
    const Scene red = load("mtllib a.mtl\nusemtl m # x\n" + corners_of_a_square + "f 1 2 3\nusemtl\nf 1 3 4\n");
    EXPECT_EQ(red.materials.at(0).diffuse_albedo, vec3(1, 0, 0));
    EXPECT_EQ(count_warnings(red, "1 faces without a material are drawn in grey"), 1u);
}

TEST_F(MeshFile, VerticesAreSplitWhereNormalsDiffer) {
    const Scene scene = load(corners_of_a_square + "vn 0 0 2\nvn 1 0 1\nf 1//1 2//1 3//1\nf 1//1 3//2 4//1\n");
    EXPECT_EQ(scene.positions.size(), 5u);
    ASSERT_EQ(scene.normals.size(), 5u);
    for (const vec3& normal : scene.normals) EXPECT_NEAR(glm::length(normal), 1, 1e-6f);
    const uvec3 second = scene.triangles.at(1);
    EXPECT_EQ(scene.normals.at(second.x), vec3(0, 0, 1));
    EXPECT_NEAR(scene.normals.at(second.y).x, std::sqrt(0.5f), 1e-6f);
}

TEST_F(MeshFile, CornersWithoutANormalGetTheGeometricOne) {
    // The second triangle has no normals, the third one a zero normal; both stand on the edge of the first.
    const Scene scene =
        load(corners_of_a_square + "v 0 0 1\nvn 0 0 1\nvn 0 0 0\n" + "f 1//1 2//1 3//1\nf 1 2 5\nf 1//2 5//2 4//2\n");
    ASSERT_EQ(scene.triangles.size(), 3u);
    ASSERT_EQ(scene.normals.size(), scene.positions.size());
    const vec3 expected[] = {{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}};
    for (size_t i = 0; i < 3; ++i)
        for (int corner = 0; corner < 3; ++corner) EXPECT_EQ(scene.normals.at(scene.triangles[i][corner]), expected[i]) << i;
}

TEST_F(MeshFile, AMeshWithoutNormalsStaysFlatBesideASmoothOne) {
    folder.write("flat.obj", corners_of_a_square + "v 0 0 1\nf 1 2 3 4\nf 1 2 5\n");
    folder.write("smooth.obj", corners_of_a_square + "vn 0 1 1\nf 1//1 2//1 3//1\n");
    const Scene scene = load_scene(folder.write("a.json", R"({"meshes": [{"file": "flat.obj"}, {"file": "smooth.obj"}]})"));
    ASSERT_EQ(scene.normals.size(), scene.positions.size());
    for (size_t i = 0; i < 3; ++i)
        for (int corner = 0; corner < 3; ++corner) EXPECT_EQ(scene.normals.at(scene.triangles[i][corner]), face_normal(scene, i));
    EXPECT_NEAR(scene.normals.at(scene.triangles.at(3).x).y, std::sqrt(0.5f), 1e-6f);
}

TEST_F(MeshFile, TheFrontIsTheSideOfTheVertexNormals) {
    const std::string normals = "vn 0 0 -1\nvn 1 0 1\n";
    EXPECT_EQ(face_normal(load(corners_of_a_square + "f 1 2 3\n"), 0), vec3(0, 0, 1));
    EXPECT_EQ(face_normal(load(corners_of_a_square + normals + "f 1//1 2//1 3//1\n"), 0), vec3(0, 0, -1));
    EXPECT_EQ(face_normal(load(corners_of_a_square + normals + "f 3//2 2//2 1//2\n"), 0), vec3(0, 0, 1));
    // One corner against two, and a single corner.
    EXPECT_EQ(face_normal(load(corners_of_a_square + normals + "f 1//1 2//1 3//2\n"), 0), vec3(0, 0, -1));
    EXPECT_EQ(face_normal(load(corners_of_a_square + normals + "f 1//1 2 3\n"), 0), vec3(0, 0, -1));
}

TEST_F(MeshFile, TurningATriangleKeepsItsVerticesAttributes) {
    folder.write("a.mtl", "newmtl m\nmap_Kd a.png\n");
    write_png(folder / "a.png", {1, 1, {255, 255, 255, 255}});
    const Scene scene =
        load("mtllib a.mtl\nusemtl m\n" + corners_of_a_square + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 -1\nf 1/1/1 2/2/1 3/3/1\n");
    ASSERT_EQ(scene.texture_coordinates.size(), 3u);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(scene.texture_coordinates[i], vec2(scene.positions[i].x, 1 - scene.positions[i].y));
}

TEST_F(MeshFile, TextureCoordinatesPointDownAndAreKeptOnlyForTextures) {
    const std::string obj = "mtllib a.mtl\nusemtl m\n" + corners_of_a_square + "vt 0.25 0.125\nf 1/1 2/1 3\n";
    folder.write("a.mtl", "newmtl m\nmap_Kd textures\\a.png\n");
    std::filesystem::create_directory(folder / "textures");
    write_png(folder / "textures/a.png", {1, 2, {1, 2, 3, 255, 4, 5, 6, 255}});
    const Scene scene = load(obj);
    ASSERT_EQ(scene.texture_coordinates.size(), scene.positions.size());
    EXPECT_EQ(scene.texture_coordinates.at(scene.triangles.at(0).x), vec2(0.25f, 0.875f));
    EXPECT_EQ(scene.texture_coordinates.at(scene.triangles.at(0).z), vec2(0));
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.textures[0].pixels, (std::vector<uint8_t>{1, 2, 3, 255, 4, 5, 6, 255}));
    EXPECT_EQ(scene.materials.at(0).albedo_texture, 0);
    EXPECT_EQ(scene.materials.at(0).diffuse_albedo, vec3(1)) << "map_Kd alone means a white Kd";

    folder.write("a.mtl", "newmtl m\nKd 1 1 1\n");
    EXPECT_TRUE(load(obj).texture_coordinates.empty());
}

TEST_F(MeshFile, TextureCoordinatesTooCoarseForTheirTextureAreNamed) {
    folder.write("a.mtl", "newmtl m\nmap_Kd a.png\n");
    write_png(folder / "a.png", {64, 1, std::vector<uint8_t>(size_t{4} * 64, 200)});
    const auto warnings = [&](const std::string& coordinates) {
        auto all = load("mtllib a.mtl\nusemtl m\n" + corners_of_a_square + "vt " + coordinates + "\nf 1/1 2/1 3/1\n").warnings;
        std::erase_if(all, [](const std::string& line) { return line.find("texture coordinates") == std::string::npos; });
        return all;
    };
    // Floats between 2^16 and 2^17 are 2^-7 apart, between 2^17 and 2^18 2^-6: a texel of 64.
    EXPECT_TRUE(warnings("0.5 -1000").empty());
    EXPECT_TRUE(warnings("262143 0").empty());
    const auto found = warnings("0 -1000000.5");
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NE(found[0].find("reach 1e+06"), std::string::npos) << found[0];
    EXPECT_NE(found[0].find("steps of 4 texels"), std::string::npos) << found[0];
}

TEST_F(MeshFile, TexturesAreLoadedOnce) {
    folder.write("a.mtl", "newmtl m\nKd 1 0 1\nmap_Kd a.png\nnewmtl n\nmap_Kd ./a.png\nKd 0 1 0\n");
    write_png(folder / "a.png", {1, 1, {9, 9, 9, 255}});
    const Scene scene = load("mtllib a.mtl\n" + corners_of_a_square + "usemtl n\nf 1 2 3\nusemtl m\nf 1 3 4\n");
    EXPECT_EQ(scene.textures.size(), 1u);
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.materials.at(scene.triangle_materials.at(0)).diffuse_albedo, vec3(0, 1, 0));
    EXPECT_EQ(scene.materials.at(scene.triangle_materials.at(1)).diffuse_albedo, vec3(1, 0, 1));
}

TEST_F(MeshFile, TrianglesWithoutAreaAreLeftOutAndCounted) {
    const Scene scene = load(corners_of_a_square + "v 0.5 0 0\nf 1 2 3\nf 1 1 2\nf 1 2 5\nf 2 2 2\n");
    EXPECT_EQ(scene.triangles.size(), 1u);
    EXPECT_EQ(scene.triangle_materials.size(), 1u);
    EXPECT_EQ(count_warnings(scene, "3 triangles without area"), 1u);
    EXPECT_USER_ERROR(load(corners_of_a_square + "f 1 1 2\n"), "none of its triangles has an area");
    // Size does not matter: neither under- nor overflow.
    EXPECT_EQ(load("v 0 0 0\nv 1e-30 0 0\nv 0 1e-30 0\nv 1 0 0\nf 1 2 3\nf 1 4 3\n").triangles.size(), 2u);
    EXPECT_EQ(load("v 0 0 0\nv 1e18 0 0\nv 0 1e18 0\nf 1 2 3\n").triangles.size(), 1u);
}

TEST_F(MeshFile, DamagedMeshesNameFileAndLine) {
    std::string many_corners = "f";
    for (int i = 0; i < 257; ++i) many_corners += i % 2 ? " 1" : " 2";
    const std::pair<std::string, const char*> cases[] = {
        {"f 1 2 5", "a.obj:5: the face refers to vertex 5, but there are 4"},
        {"f 0 1 2", "a.obj:5: the face refers to vertex 0"},
        {"f -5 1 2", "a.obj:5: the face refers to vertex -5"},
        {"f 1 2 2147483648", "more than 9 digits"},
        {"f 1 2 4294967297", "more than 9 digits"},
        {"f 1/1 2/1 3/1", "texture coordinate 1, but there are 0"},
        {"f 1//1 2//1 3//1", "normal 1, but there are 0"},
        {"vn 0 0 1\nf 1//2 2//1 3//1", "a.obj:6: the face refers to normal 2"},
        {"f 1 2", "a.obj:5: a face needs at least 3 corners"},
        {"f 1 2 3 x", "must be made of vertex indices"},
        {"f 1.0 2.0 3.0", "must be made of vertex indices"},
        {many_corners, "at most 256 corners"},
        {"v nan 0 0\nf 1 2 3", "a.obj:5: \"nan\" is not a finite number"},
        {"v 0 inf 0\nf 1 2 3", "\"inf\""},
        {"v 0 0 1e39\nf 1 2 3", "\"1e39\""},
        {"v 0 0\nf 1 2 3", "a.obj:5: v needs 3 numbers"},
        {"v 0 0 O\nf 1 2 3", "\"O\""},
        {"vn 0 0\nf 1 2 3", "vn needs 3 numbers"},
        {"vt\tnan\nf 1 2 3", "\"nan\""},
        {"vt 0 -1e7\nf 1 2 3", "2^23"},
        {"# no face", "no faces"},
        {"l 1 2 3", "no faces"},
        {std::string("f 1 2 3\0", 8), "binary"},
    };
    for (const auto& [lines, part] : cases)
        EXPECT_PRED_FORMAT2(IsSubstring, part, user_error([&, line = lines] { load(corners_of_a_square + line + "\n"); }))
            << lines;
    EXPECT_USER_ERROR(load("\x89PNG\r\n\x1a\n"), "no faces");
    EXPECT_USER_ERROR(load(std::string(100000, 'f')), "no faces");
    EXPECT_USER_ERROR(load("v 3e38 0 0\nv -3e38 0 0\nv 0 3e38 0\nf 1 2 3\n"), "too large");
}

TEST_F(MeshFile, DamagedFilesAreRefusedOrRead) {
    folder.write("good.mtl", "newmtl m\nKd 0.5 0.5 0.5\n");
    std::string obj = "mtllib good.mtl\nusemtl m\n" + corners_of_a_square + "vt 0 0\nvt 1 0\nvn 0 0 1\n";
    for (int i = 0; i < 30; ++i) obj += "f 1/1/1 2/2/1 3/1/1 4/2/1\nf -4//-1 -2//-1 -1//-1\n";
    damage(folder, "damaged.obj", obj, false, [](const auto& file) { load_scene(file); });

    folder.write("b.obj", "mtllib damaged.mtl\nusemtl m\n" + corners_of_a_square + "f 1 2 3\n");
    damage(folder, "damaged.mtl", "newmtl m\nKd 0.5 0.5 0.5\nKe 1 2 3\nKs 0.1 0.2 0.3\nNs 7\nd 0.5\nNi 1.5\nTf 0.5 1 1\n", false,
           [&](const auto&) { load_scene(folder / "b.obj", true); });
}

}  // namespace
}  // namespace lab
