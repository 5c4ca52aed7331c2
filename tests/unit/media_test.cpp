// Media in scene files: their keys, and which medium is on which side of a mesh.
#include <cmath>
#include <limits>

#include "scene/features.h"
#include "scene/scene.h"
#include "test_files.h"

namespace lab {
namespace {

using testing::IsSubstring;

const std::string glass = "newmtl m\nd 0\nNi 1.5\n", opaque = "newmtl m\nKd 1 1 1\n";

// A tetrahedron around the origin with an inscribed sphere of radius 1/√3.
const std::string tetrahedron =
    "mtllib m.mtl\nv 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nusemtl m\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";

class MediaFile : public testing::Test {
  protected:
    Scene load(const std::string& meshes, const std::string& keys = "", const std::string& material = opaque) const {
        folder.write("m.mtl", material);
        folder.write("a.obj", tetrahedron);
        return load_scene(folder.write("scene.json", "{\"meshes\": [" + meshes + "]" + keys + "}"));
    }
    void expect_refused(const std::string& meshes, const std::string& keys, const std::string& reason,
                        const std::string& material = opaque) const {
        EXPECT_USER_ERROR(load(meshes, keys, material), reason);
    }

    TestFolder folder;
};

const std::string plain = R"({"file": "a.obj"})";
std::string placed(const std::string& keys) { return R"({"file": "a.obj", )" + keys + "}"; }
std::string open(const std::string& extinction, const std::string& keys = "") {
    return placed(R"("medium": {"extinction": )" + extinction + R"(, "albedo": 0.5, "boundary": "open"})" + keys);
}

// Of the first triangle of an instance.
Boundary boundary_of(const Scene& scene, uint32_t instance) {
    const auto place = [&](size_t i) { return scene.boundary_places.at(i); };
    return scene.boundaries.at(place(scene.mesh_of(instance).first_triangle) + place(scene.triangles.size() + instance));
}

TEST_F(MediaFile, AreAbsentUnlessAsked) {
    const Scene scene = load(plain);
    EXPECT_TRUE(scene.media.empty());
    EXPECT_TRUE(scene.boundaries.empty());
    EXPECT_FALSE(features_of(scene).media);
}

TEST_F(MediaFile, StateTheFog) {
    const Scene scene = load(plain, R"(, "fog": {"extinction": 0.5, "albedo": [0.1, 0.2, 0.3], "anisotropy": -0.4})");
    ASSERT_EQ(scene.media.size(), 1u);
    EXPECT_EQ(scene.media[0].extinction, 0.5f);
    EXPECT_EQ(scene.media[0].albedo, vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(scene.media[0].anisotropy, -0.4f);
    EXPECT_TRUE(scene.boundaries.empty()) << "it ends nowhere";
    EXPECT_TRUE(features_of(scene).media);
}

TEST_F(MediaFile, FogWithoutEndHidesTheSky) {
    const std::string fog = R"(, "fog": {"extinction": 0.5, "albedo": 1})", sky = R"(, "background": {"radiance": 1})";
    EXPECT_TRUE(load(plain, fog).warnings.empty());
    EXPECT_TRUE(load(plain, sky).warnings.empty());
    const auto warnings = load(plain, fog + sky).warnings;
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_PRED_FORMAT2(IsSubstring, "hides the sky", warnings[0]);
}

// Nested in any order, by any number of meshes, and past one that is not around them.
TEST_F(MediaFile, KnowWhatLiesAroundThem) {
    const Scene scene =
        load(open("3", R"(, "scale": 0.05)") + ", " + open("1") + ", " + open("4", R"(, "translation": [9, 0, 0])") + ", " +
                 open("2", R"(, "scale": [-0.3, 0.3, 0.3])") + ", " + plain,
             R"(, "fog": {"extinction": 7, "albedo": 1})");
    const auto extinctions = [&](uint32_t instance) {
        const Boundary boundary = boundary_of(scene, instance);
        return std::pair(scene.media.at(boundary.behind).extinction, scene.media.at(boundary.before).extinction);
    };
    EXPECT_EQ(extinctions(0), std::pair(3.0f, 2.0f));
    EXPECT_EQ(extinctions(1), std::pair(1.0f, 7.0f));
    EXPECT_EQ(extinctions(2), std::pair(4.0f, 7.0f));
    EXPECT_EQ(extinctions(3), std::pair(2.0f, 1.0f));
    EXPECT_EQ(boundary_of(scene, 4).kind, BOUNDARY_NONE);
}

TEST_F(MediaFile, FillGlass) {
    const Scene scene = load(plain, R"(, "fog": {"extinction": 7, "albedo": 1})", glass);
    EXPECT_EQ(boundary_of(scene, 0).kind, BOUNDARY_GLASS);
    EXPECT_EQ(scene.media.at(boundary_of(scene, 0).behind).extinction, 0) << "clear glass displaces the fog";
}

TEST_F(MediaFile, ThatCannotBeAreRefused) {
    const auto fog = [](const std::string& keys) { return R"(, "fog": {)" + keys + "}"; };
    expect_refused(plain, fog(R"("albedo": 1)"), "\"extinction\" in \"fog\" is missing");
    expect_refused(plain, fog(R"("extinction": 1)"), "\"albedo\" in \"fog\" is missing");
    expect_refused(plain, fog(R"("extinction": -1, "albedo": 1)"), "from 0 to 1e9");
    expect_refused(plain, fog(R"("extinction": 1e10, "albedo": 1)"), "from 0 to 1e9");
    expect_refused(plain, fog(R"("extinction": 1, "albedo": 1.1)"), "\"albedo\" in \"fog\" must be from 0 to 1");
    expect_refused(plain, fog(R"("extinction": 1, "albedo": [0, -0.1, 0])"), "from 0 to 1");
    expect_refused(plain, fog(R"("extinction": 1, "albedo": 1, "anisotropy": 1)"), "from -0.999 to 0.999");
    expect_refused(plain, fog(R"("extinction": 1, "albedo": 1, "boundary": "open")"), "unknown key");
    expect_refused(placed(R"("medium": {"extinction": 1, "albedo": 1, "boundary": "closed"})"), "", "can only be \"open\"");
    const std::string filled = placed(R"("medium": {"extinction": 1, "albedo": 1})");
    expect_refused(filled, "", "behind an opaque surface");
    expect_refused(filled, "", "absorbing glass", glass + "Tf 0.5 1 1\n");
    expect_refused(open("1"), "", "cannot emit", "newmtl m\nKe 1 1 1\n");
}

// A grid of densities as its file holds it, after a change.
std::string grid_file(const std::vector<float>& densities, std::vector<int32_t> numbers = {1, 2, 1, 2, 1}) {
    const auto bytes = [](const auto& values) {
        return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
    };
    return "VOL\3" + bytes(numbers) + bytes(std::vector<float>(6)) + bytes(densities);
}

class DensityFile : public MediaFile {
  protected:
    static constexpr const char* box = R"("box": [[-1, -2, -3], [1, 2, 3]])";
    Scene load_grid(const std::string& content, const std::string& keys = box, float extinction = 1) const {
        folder.write("smoke.vol", content);
        return load(plain, R"(, "background": {"radiance": 1}, "fog": {"albedo": 1, "extinction": )" +
                               std::to_string(extinction) + R"(, "density": "smoke.vol", )" + keys + "}");
    }
};

TEST_F(DensityFile, IsReadWithItsBox) {
    const Scene scene = load_grid(grid_file({0, 0.5f, 3, 1}));
    EXPECT_TRUE(scene.warnings.empty()) << "this fog has an end and hides no sky";
    const Medium& medium = scene.media.at(0);
    EXPECT_EQ(medium.grid_size, uvec3(2, 1, 2));
    EXPECT_EQ(medium.largest_density, 3);
    EXPECT_EQ(medium.low, vec3(-1, -2, -3));
    EXPECT_EQ(medium.high, vec3(1, 2, 3));
    EXPECT_EQ(scene.densities, (std::vector<float>{0, 0.5f, 3, 1}));
    EXPECT_EQ(scene.sources.back().filename(), "smoke.vol") << "or changes would not be seen";
}

TEST_F(DensityFile, OfZerosIsVacuum) {
    const Scene scene = load_grid(grid_file({0, 0, 0, 0}));
    EXPECT_EQ(scene.media.at(0).extinction, 0);
    EXPECT_TRUE(scene.densities.empty());
}

TEST_F(DensityFile, SharesOneArrayWithOthers) {
    folder.write("smoke.vol", grid_file({1, 2, 3, 4}));
    const std::string keys = std::string(R"(, "density": "smoke.vol", )") + box;
    const Scene scene = load(placed(R"("medium": {"extinction": 1, "albedo": 1, "boundary": "open")" + keys + "}"),
                             R"(, "fog": {"extinction": 1, "albedo": 1)" + keys + "}");
    EXPECT_EQ(scene.media.at(0).first_density, 0u);
    EXPECT_EQ(scene.media.at(1).first_density, 4u);
    EXPECT_EQ(scene.densities.size(), 8u);
}

TEST_F(DensityFile, ThatCannotBeIsRefused) {
    const auto refuse = [&](const std::string& content, const std::string& reason, const std::string& keys = box) {
        EXPECT_USER_ERROR(load_grid(content, keys), reason);
    };
    const std::vector<float> fine{0, 1, 2, 3};
    refuse("", "the file is empty");
    refuse(grid_file(fine).substr(0, 47), "too short");
    refuse(grid_file({1, 2, 3}), "ends early");
    refuse(grid_file({1, 2, 3, 4, 5}), "ends late");
    refuse("VOL\2" + grid_file(fine).substr(4), "no grid of densities");
    refuse("PNG!" + grid_file(fine).substr(4), "no grid of densities");
    refuse(grid_file(fine, {3, 2, 1, 2, 1}), "one channel of 32-bit numbers");
    refuse(grid_file(fine, {1, 2, 1, 2, 3}), "one channel of 32-bit numbers");
    refuse(grid_file(fine, {1, 0, 1, 2, 1}), "impossible size");
    refuse(grid_file(fine, {1, -2, 1, 2, 1}), "impossible size");
    refuse(grid_file(fine, {1, 1 << 24, 1 << 24, 1 << 24, 1}), "more than");
    refuse(grid_file({1, -2, 3, 4}), "its cell 1 is negative or not finite");
    refuse(grid_file({1, 2, 3, std::numeric_limits<float>::infinity()}), "its cell 3 is negative or not finite");
    refuse(grid_file({NAN, 2, 3, 4}), "its cell 0 is negative or not finite");
    refuse(grid_file({1, 2, 3, 1e4f}), "more than 3000 times");
    refuse(grid_file(fine), "two corners of three numbers", R"("box": [[0, 0, 0]])");
    refuse(grid_file(fine), "two corners of three numbers", R"("box": [[0, 0, 0], [1, 1]])");
    refuse(grid_file(fine), "two corners of three numbers", R"("box": [[0, 0, 0], [1, 1, "a"]])");
    refuse(grid_file(fine), "two corners of three numbers", R"("box": [[0, 0, 0], [1, 0, 1]])");
    refuse(grid_file(fine), "\"box\"", R"("anisotropy": 0)");
    expect_refused(plain, R"(, "fog": {"extinction": 1, "albedo": 1, "box": [[0, 0, 0], [1, 1, 1]]})", "needs a \"density\"");
    expect_refused(plain, std::string(R"(, "fog": {"extinction": 1, "albedo": 1, "density": "none.vol", )") + box + "}",
                   "none.vol");
}

}  // namespace
}  // namespace lab
