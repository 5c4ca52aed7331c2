// Scene descriptions, cameras and features.
#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/features.h"
#include "test_files.h"

namespace lab {
namespace {

using testing::IsSubstring;

const std::string triangle_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string one_mesh = R"("meshes": [{"file": "a.obj"}])";

class SceneFile : public testing::Test {
  protected:
    SceneFile() { folder.write("a.obj", triangle_obj); }

    Scene load(const std::string& json, bool specular = false) const {
        return load_scene(folder.write("scene.json", json), specular);
    }

    // The instance that these transformation keys produce.
    Instance instance(const std::string& keys) const {
        return load(R"({"meshes": [{"file": "a.obj", )" + keys + "}]}").instances.at(0);
    }

    TestFolder folder;
};

void expect_close(const vec3& actual, const vec3& expected, float tolerance = 1e-6f) {
    EXPECT_LE(glm::distance(actual, expected), tolerance) << actual.x << " " << actual.y << " " << actual.z << " instead of "
                                                          << expected.x << " " << expected.y << " " << expected.z;
}

bool contains(const std::vector<std::string>& warnings, const std::string& part) {
    return std::any_of(warnings.begin(), warnings.end(),
                       [&](const std::string& warning) { return warning.find(part) != std::string::npos; });
}

TEST_F(SceneFile, StatesEverything) {
    const Scene scene = load(R"({
        "description": "a test", "meshes": [{"file": "a.obj"}],
        "camera": {"position": [1, 2, 3], "target": [4, 5, 6], "up": [0, 0, 1], "vertical_fov": 30.5},
        "background": {"radiance": [0.5, 1, 2]},
        "specular": false, "width": 640, "height": 480, "samples": 16, "max_path_length": 0})");
    EXPECT_EQ(scene.description, "a test");
    EXPECT_EQ(scene.camera.position, vec3(1, 2, 3));
    EXPECT_EQ(scene.camera.target, vec3(4, 5, 6));
    EXPECT_EQ(scene.camera.up, vec3(0, 0, 1));
    EXPECT_EQ(scene.camera.vertical_fov, 30.5f);
    EXPECT_EQ(scene.background, vec3(0.5f, 1, 2));
    EXPECT_FALSE(scene.light_probe);
    EXPECT_EQ(scene.defaults.width, 640u);
    EXPECT_EQ(scene.defaults.height, 480u);
    EXPECT_EQ(scene.defaults.samples, 16u);
    EXPECT_EQ(scene.defaults.max_path_length, 0u);
    EXPECT_EQ(scene.triangles.size(), 1u);
}

TEST_F(SceneFile, HasDefaults) {
    const Scene scene = load("{" + one_mesh + "}");
    EXPECT_EQ(scene.background, vec3(0));
    EXPECT_EQ(scene.defaults.width, 512u);
    EXPECT_EQ(scene.defaults.height, 512u);
    EXPECT_EQ(scene.defaults.samples, 64u);
    EXPECT_EQ(scene.defaults.max_path_length, 8u);
    EXPECT_EQ(scene.instances.at(0).object_to_world, mat4x3(1));
    EXPECT_EQ(scene.instances.at(0).normal_to_world, mat3(1));
}

TEST_F(SceneFile, MayBeOnlySky) {
    const Scene scene = load(R"({"meshes": [], "background": {"radiance": 1}})");
    EXPECT_TRUE(scene.triangles.empty());
    EXPECT_TRUE(scene.instances.empty());
    EXPECT_GT(world_bounds(scene).low.x, world_bounds(scene).high.x);
    EXPECT_EQ(features_of(scene).defines(), std::vector<std::string>{"FEATURE_SKY"});
    EXPECT_NO_THROW(make_camera(scene.camera, 16, 16));
}

TEST_F(SceneFile, LightProbe) {
    write_hdr(folder / "sky.hdr", {2, 1, {1, 2, 4, 8, 16, 32}});
    const Scene scene =
        load(R"({"meshes": [], "background": {"light_probe": "sky.hdr", "intensity": 3, "rotation_degrees": 90}})");
    ASSERT_TRUE(scene.light_probe);
    EXPECT_EQ(scene.light_probe->pixels, (std::vector<float>{1, 2, 4, 8, 16, 32}));
    EXPECT_EQ(scene.background, vec3(3));
    EXPECT_FLOAT_EQ(scene.probe_rotation, std::numbers::pi_v<float> / 2);
    EXPECT_EQ(features_of(scene).defines(), std::vector<std::string>{"FEATURE_LIGHT_PROBE"});
}

TEST_F(SceneFile, MeshesAreRelativeToItsFolderAndLoadedOnce) {
    folder.write("meshes/b.obj", triangle_obj);
    const Scene scene = load(R"({"meshes": [{"file": "meshes/b.obj"}, {"file": "a.obj"},
                                            {"file": "meshes/../meshes/b.obj", "translation": [5, 0, 0]}]})");
    EXPECT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(scene.positions.size(), 6u);
    EXPECT_EQ(scene.instance_meshes, (std::vector<uint32_t>{0, 1, 0}));
    EXPECT_EQ(scene.meshes[1].first_triangle, 1u);
    EXPECT_EQ(scene.meshes[1].triangle_count, 1u);
    EXPECT_GE(scene.triangles[1].x, 3u) << "indices must refer to the arrays of the whole scene";
    EXPECT_EQ(scene.instances[2].object_to_world[3], vec3(5, 0, 0));
}

TEST_F(SceneFile, TransformsScaleThenRotateThenTranslate) {
    const Instance all =
        instance(R"("scale": [2, 3, 4], "rotation": {"axis": [0, 0, 2], "degrees": 90}, "translation": [10, 20, 30])");
    // Object x becomes 2 long along +Y, object y 3 long along -X.
    expect_close(all.object_to_world[0], {0, 2, 0});
    expect_close(all.object_to_world[1], {-3, 0, 0});
    expect_close(all.object_to_world[2], {0, 0, 4});
    expect_close(all.object_to_world[3], {10, 20, 30});
    expect_close(instance(R"("scale": 2)").object_to_world[2], {0, 0, 2});
}

TEST_F(SceneFile, NormalsStayPerpendicularAndKeepTheFront) {
    for (const char* keys : {R"("scale": [2, 3, 4])", R"("scale": [1, 1, -2])", R"("scale": [-1, -2, -3])",
                             R"("scale": [2, 1, 1], "rotation": {"axis": [1, 2, 3], "degrees": 77})"}) {
        const Instance placed = instance(keys);
        const vec3 a(1, 2, 0.5f), b(-1, 0.25f, 3);
        const mat3 linear(placed.object_to_world);
        const vec3 normal = placed.normal_to_world * glm::cross(a, b);
        const float length = glm::length(normal);
        EXPECT_NEAR(glm::dot(normal, linear * a) / length, 0, 1e-5f) << keys;
        EXPECT_NEAR(glm::dot(normal, linear * b) / length, 0, 1e-5f) << keys;
        // What is in front of the triangle stays in front, mirrored or not.
        EXPECT_GT(glm::dot(normal, linear * glm::cross(a, b)), 0) << keys;
    }
}

TEST_F(SceneFile, WorldBounds) {
    const Scene scene = load(R"({"meshes": [{"file": "a.obj", "scale": [-2, 1, 1]},
                                            {"file": "a.obj", "translation": [0, 0, 7]}]})");
    EXPECT_EQ(world_bounds(scene).low, vec3(-2, 0, 0));
    EXPECT_EQ(world_bounds(scene).high, vec3(1, 1, 7));
}

TEST_F(SceneFile, MaterialsMayReplaceThoseOfAMesh) {
    folder.write("two.obj", "mtllib own.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n");
    folder.write("own.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n");
    folder.write("more/gold.mtl", "newmtl gold\nKd 0 0 1\nmap_Kd a.png\n");
    write_png(folder / "more/a.png", {1, 1, {255, 255, 255, 255}});
    folder.write("swapped.mtl", "newmtl b\nKd 1 0 0\nnewmtl a\nKd 0 1 0\n");
    const Scene scene =
        load(R"({"meshes": [{"file": "two.obj"}, {"file": "two.obj", "materials": "more/gold.mtl", "translation": [0, 0, 1]},
                                            {"file": "two.obj", "materials": "swapped.mtl", "translation": [0, 0, 2]},
                                            {"file": "two.obj", "materials": "more/../more/gold.mtl", "translation": [0, 0, 3]}]})");
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.instance_meshes, (std::vector<uint32_t>{0, 1, 2, 1}));
    std::vector<vec3> albedos;
    for (const uint32_t material : scene.triangle_materials) albedos.push_back(scene.materials.at(material).diffuse_albedo);
    const vec3 red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1);
    EXPECT_EQ(albedos, (std::vector<vec3>{red, green, blue, blue, green, red}));
    EXPECT_EQ(scene.textures.size(), 1u);
    EXPECT_USER_ERROR(load(R"({"meshes": [{"file": "two.obj", "materials": "none.mtl"}]})"), "none.mtl");
    EXPECT_USER_ERROR(load(R"({"meshes": [{"file": "two.obj", "materials": 3}]})"), "\"materials\"");
}

TEST_F(SceneFile, UnknownKeysAreNamedWithTheKnownOnes) {
    const std::pair<const char*, const char*> cases[] = {
        {R"({"meshes": [], "sample": 4})", "known keys are description, meshes, camera"},
        {R"({"meshes": [{"file": "a.obj", "scaling": 1}]})",
         "known keys are file, materials, medium, scale, rotation, translation"},
        {R"({"meshes": [{"file": "a.obj", "rotation": {"angle": 1}}]})", "known keys are axis, degrees"},
        {R"({"meshes": [], "camera": {"fov": 1}})", "known keys are position, target, up, vertical_fov"},
        {R"({"meshes": [], "background": {"color": 1}})", "known keys are radiance, light_probe, intensity"},
    };
    for (const auto& [json, known] : cases) {
        const std::string message = user_error([&, text = json] { load(text); });
        EXPECT_PRED_FORMAT2(IsSubstring, "unknown key", message);
        EXPECT_PRED_FORMAT2(IsSubstring, known, message);
        EXPECT_PRED_FORMAT2(IsSubstring, "scene.json", message);
    }
}

TEST_F(SceneFile, WrongValuesNameTheirKey) {
    const std::pair<const char*, const char*> cases[] = {
        {R"({"meshes": [], "width": 0})", R"("width" in the scene must be a whole number from 1 to 16384)"},
        {R"({"meshes": [], "height": 16385})", "\"height\""},
        {R"({"meshes": [], "width": 2.5})", "\"width\""},
        {R"({"meshes": [], "width": "512"})", R"("width" in the scene must be a number)"},
        {R"({"meshes": [], "samples": -1})", "\"samples\""},
        {R"({"meshes": [], "background": {"radiance": 1e39}})", R"("radiance" in "background" is beyond 3.4e38)"},
        {R"({"meshes": [{"file": ".\\a.obj", "scale": 1e-30}]})", "smaller than 1e-18 units"},
        {R"({"meshes": [], "samples": 1e300})", "\"samples\""},
        {R"({"meshes": [], "max_path_length": true})", "\"max_path_length\""},
        {R"({"meshes": [], "specular": 1})", R"("specular" in the scene must be true or false)"},
        {R"({"meshes": [], "description": 7})", "\"description\""},
        {R"({"meshes": {}})", R"("meshes" in the scene must be a list)"},
        {R"({})", "\"meshes\" in the scene is missing"},
        {R"([])", "the scene must be an object"},
        {R"(7)", "the scene must be an object"},
        {R"({"meshes": ["a.obj"]})", "an entry of \"meshes\" must be an object"},
        {R"({"meshes": [{}]})", R"("file" in an entry of "meshes" is missing)"},
        {R"({"meshes": [{"file": 3}]})", "\"file\""},
        {R"({"meshes": [{"file": ""}]})", "not a regular file"},
        {R"({"meshes": [{"file": "missing.obj"}]})", "missing.obj: no such file"},
        {R"({"meshes": [{"file": "a.obj", "scale": 0}]})", "\"scale\""},
        {R"({"meshes": [{"file": "a.obj", "scale": [1, 0, 1]}]})", "\"scale\""},
        {R"({"meshes": [{"file": "a.obj", "scale": [1, 1]}]})", "\"scale\""},
        {R"({"meshes": [{"file": "a.obj", "scale": [1, 1, null]}]})", "\"scale\""},
        {R"({"meshes": [{"file": "a.obj", "scale": 1e-42}]})", "too small or too large"},
        {R"({"meshes": [{"file": "a.obj", "scale": [3e38, 3e38, 3e38]}]})", "too large"},
        {R"({"meshes": [{"file": "a.obj", "translation": 1}]})", "\"translation\""},
        {R"({"meshes": [{"file": "a.obj", "translation": [1e39, 0, 0]}]})", "\"translation\""},
        {R"({"meshes": [{"file": "a.obj", "rotation": {"axis": [0, 0, 0], "degrees": 1}}]})", "\"axis\""},
        {R"({"meshes": [{"file": "a.obj", "rotation": {"axis": [0, 0, 1]}}]})", "\"degrees\""},
        {R"({"meshes": [{"file": "a.obj", "rotation": 90}]})", "\"rotation\" must be an object"},
        {R"({"meshes": [], "camera": {"position": [0, 0, 1]}})", R"("target" in "camera" is missing)"},
        {R"({"meshes": [], "camera": {"position": [0, 0, 0], "target": [0, 0, 0]}})", "\"target\""},
        {R"({"meshes": [], "camera": {"position": [0, 0, 1], "target": [0, 0, 0], "vertical_fov": 180}})", "\"vertical_fov\""},
        {R"({"meshes": [], "camera": {"position": [0, 0, 1], "target": [0, 0, 0], "vertical_fov": 0}})", "\"vertical_fov\""},
        {R"({"meshes": [], "background": {}})", "\"light_probe\""},
        {R"({"meshes": [], "background": {"radiance": 1, "light_probe": "a.hdr"}})", "not both"},
        {R"({"meshes": [], "background": {"radiance": [1, -1, 1]}})", "\"radiance\""},
        {R"({"meshes": [], "background": {"radiance": 1, "intensity": 2}})", "\"intensity\""},
        {R"({"meshes": [], "background": {"light_probe": "a.hdr"}})", "a.hdr: no such file"},
        {R"({"meshes": [], "background": {"light_probe": "a.obj"}})", "must be a .hdr or .exr file"},
    };
    for (const auto& [json, part] : cases)
        EXPECT_PRED_FORMAT2(IsSubstring, part, user_error([&, text = json] { load(text); })) << json;
}

TEST_F(SceneFile, SyntaxErrorsNameTheLine) {
    EXPECT_USER_ERROR(load("{\n\"meshes\": [],\n\"width\" 512\n}"), "scene.json:3: not valid JSON");
    EXPECT_USER_ERROR(load("{\"meshes\": []"), "scene.json:1: not valid JSON");
    EXPECT_USER_ERROR(load("{\"meshes\": [], \"width\": 1e999}"), "not valid JSON");
    EXPECT_USER_ERROR(load("{\"meshes\": [], \"width\": NaN}"), "not valid JSON");
    EXPECT_USER_ERROR(load(std::string("\x7f\x45\x4c\x46\0\xff\xfe", 7)), "not valid JSON");
    EXPECT_USER_ERROR(load("{\"" + std::string(100000, 'x') + "\": 1}"), "unknown key");
    EXPECT_USER_ERROR(load("{\"" + std::string(100000, 'x')), "not valid JSON");
}

TEST_F(SceneFile, NestingBombsAreRefused) {
    EXPECT_USER_ERROR(load(std::string(1000000, '[')), "nested");
    std::string objects;
    for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
    EXPECT_USER_ERROR(load(objects), "nested");
}

TEST_F(SceneFile, PathsThatAreNoScenes) {
    EXPECT_USER_ERROR(load_scene(folder / "missing.json"), "missing.json: no such file");
    EXPECT_USER_ERROR(load_scene(folder / "a.blend"), "must be a .json or .obj file");
    EXPECT_USER_ERROR(load_scene(folder.write("empty.json", "")), "empty");
    std::filesystem::create_directory(folder / "folder.obj");
    EXPECT_USER_ERROR(load_scene(folder / "folder.obj"), "not a regular file");
    folder.write("large.json", "");
    std::filesystem::resize_file(folder / "large.json", uint64_t{1} << 30);  // sparse: needs no space
    EXPECT_USER_ERROR(load_scene(folder / "large.json"), "limit");
}

TEST_F(SceneFile, DamagedFilesAreRefusedOrRead) {
    const std::string json = R"({"description": "a test",
        "meshes": [{"file": "a.obj", "scale": [2, 3, 4], "rotation": {"axis": [0, 0, 2], "degrees": 90}}],
        "camera": {"position": [1, 2, 3], "target": [4, 5, 6], "up": [0, 0, 1], "vertical_fov": 30.5},
        "background": {"radiance": [0.5, 1, 2]}, "specular": false, "width": 640})";
    damage(folder, "damaged.json", json, true, [](const auto& file) { load_scene(file); });
}

TEST_F(SceneFile, HashCoversAllFilesButNotTheirPlace) {
    const auto write = [&](const std::string& root, const char* json, const char* mtl, uint8_t texel, float sky) {
        folder.write(root + "/a.mtl", mtl);
        folder.write(root + "/a.obj", "mtllib a.mtl\nusemtl m\n" + triangle_obj);
        write_png(folder / (root + "/a.png"), {1, 1, {texel, 0, 0, 255}});
        write_hdr(folder / (root + "/a.hdr"), {1, 1, {sky, 0, 0}});
        return load_scene(folder.write(root + "/a.json", json)).hash;
    };
    const char* json = R"({"meshes": [{"file": "a.obj"}], "background": {"light_probe": "a.hdr"}})";
    const char* mtl = "newmtl m\nmap_Kd a.png\n";
    const uint64_t hash = write("one", json, mtl, 7, 1);
    EXPECT_EQ(write("two", json, mtl, 7, 1), hash);
    EXPECT_NE(write("two", (json + std::string(" ")).c_str(), mtl, 7, 1), hash);
    EXPECT_NE(write("two", json, "newmtl m\n\nmap_Kd a.png\n", 7, 1), hash);
    EXPECT_NE(write("two", json, mtl, 8, 1), hash);
    EXPECT_NE(write("two", json, mtl, 7, 2), hash);
}

TEST_F(SceneFile, HashIsFnv1a) {
    // Computed from the definition: offset basis 0xcbf29ce484222325, prime 0x100000001b3.
    uint64_t expected = 0xcbf29ce484222325u;
    for (const char byte : triangle_obj) expected = (expected ^ static_cast<uint8_t>(byte)) * 0x100000001b3u;
    EXPECT_EQ(load_scene(folder / "a.obj").hash, expected);
}

TEST_F(SceneFile, BareMeshIsLitAndInView) {
    const Scene scene = load_scene(folder / "a.obj");
    EXPECT_EQ(scene.background, vec3(1));
    EXPECT_TRUE(contains(scene.warnings, "nothing in it emits light"));

    const Camera camera = make_camera(scene.camera, 512, 512);
    EXPECT_GT(camera.position.z, 0);
    EXPECT_LT(camera.forward.y, 0) << "it should look slightly down";
    for (const vec3& point : scene.positions) {
        const vec3 to_point = point - camera.position;
        const float depth = glm::dot(to_point, camera.forward);
        EXPECT_GT(depth, 0);
        EXPECT_LT(std::abs(glm::dot(to_point, camera.right)) / glm::dot(camera.right, camera.right), depth);
        EXPECT_LT(std::abs(glm::dot(to_point, camera.up)) / glm::dot(camera.up, camera.up), depth);
    }
}

TEST_F(SceneFile, BareMeshWithLightsHasABlackSky) {
    folder.write("b.mtl", "newmtl light\nKe 1 2 3\n");
    const Scene scene = load_scene(folder.write("b.obj", "mtllib b.mtl\nusemtl light\n" + triangle_obj));
    EXPECT_EQ(scene.background, vec3(0));
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(features_of(scene).defines(), std::vector<std::string>{});
    EXPECT_TRUE(features_of(scene).area_lights);
}

TEST_F(SceneFile, FeaturesAreWhatTheSceneNeeds) {
    EXPECT_TRUE(features_of(load("{" + one_mesh + "}")).defines().empty());
    folder.write("b.mtl",
                 "newmtl unused\nKe 1 1 1\nmap_Kd missing.png\n"
                 "newmtl all\nKd 0.5 0.5 0.5\nKs 0.1 0.1 0.1\nNs 10\nd 0\nNi 1.5\nTf 0.5 1 1\nmap_Kd b.png\n");
    write_png(folder / "b.png", {1, 1, {1, 2, 3, 255}});
    folder.write("b.obj", "mtllib b.mtl\nusemtl all\nvn 0 0 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n");
    const std::vector<std::string> expected = {"FEATURE_SPECULAR",  "FEATURE_VERTEX_NORMALS", "FEATURE_TEXTURES",
                                               "FEATURE_SKY",       "FEATURE_DIELECTRICS",    "FEATURE_ABSORPTION",
                                               "FEATURE_TRANSFORMS"};
    const std::string json = R"({"meshes": [{"file": "b.obj", "scale": 2}], "background": {"radiance": 1}})";
    EXPECT_EQ(features_of(load(json, true)).defines(), expected);
    EXPECT_FALSE(features_of(load(json)).specular());
}

TEST(Camera, SpansTheImagePlane) {
    const Camera camera = make_camera({{1, 2, 3}, {1, 2, -7}, {0, 5, 0}, 90}, 200, 100);
    expect_close(camera.position, {1, 2, 3});
    expect_close(camera.forward, {0, 0, -1});
    expect_close(camera.right, {2, 0, 0});
    expect_close(camera.up, {0, 1, 0});
}

TEST(Camera, UpNeedNotBePerpendicularButIsReplacedAlongTheLineOfSight) {
    expect_close(make_camera({{0, 0, 0}, {0, -1, -1}, {0, 1, 0}, 90}, 1, 1).up, glm::normalize(vec3(0, 1, -1)));
    expect_close(make_camera({{0, 5, 0}, {0, 0, 0}, {0, 1, 0}, 90}, 1, 1).up, {0, 0, -1});
    expect_close(make_camera({{0, 0, 5}, {0, 0, 0}, {0, 0, 3}, 90}, 1, 1).up, {0, 1, 0});
}

TEST(Camera, RefusesPosesWithoutADirection) {
    const float nan = std::nanf("");
    for (const CameraPose& pose :
         {CameraPose{{1, 1, 1}, {1, 1, 1}, {0, 1, 0}, 45}, CameraPose{{nan, 0, 0}, {1, 1, 1}, {0, 1, 0}, 45},
          CameraPose{{0, 0, 0}, {0, INFINITY, 0}, {0, 1, 0}, 45}, CameraPose{{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, 45},
          CameraPose{{0, 0, 0}, {1, 1, 1}, {0, nan, 0}, 45}, CameraPose{{0, 0, 0}, {1, 1, 1}, {0, INFINITY, 0}, 45},
          CameraPose{{0, 0, 0}, {1, 1, 1}, {0, 1, 0}, 0}, CameraPose{{0, 0, 0}, {1, 1, 1}, {0, 1, 0}, 180},
          CameraPose{{0, 0, 0}, {1, 1, 1}, {0, 1, 0}, nan}})
        EXPECT_USER_ERROR(make_camera(pose, 16, 16), "camera");
}

}  // namespace
}  // namespace lab
