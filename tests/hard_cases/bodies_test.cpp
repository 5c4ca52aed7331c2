// Bodies on all backends: a path's record of its medium, closed forms where bodies touch something or overlap, and media under a
// sky. All rays of a picture look the same way, so that a single number is right for all of it.
#include <cmath>
#include <fstream>

#include "files/project_folder.h"
#include "hard_cases/probe.h"
#include "scene/media.h"
#include "support/gpu_test.h"
#include "support/obj_text.h"
#include "support/temporary_folder.h"

namespace lab {
namespace {

// A box of an .obj file, after `count` others.
std::string box(const vec3& low, const vec3& high, int count = 0) { return box_text(low, high, 8 * count + 1); }

const std::string white_floor = "v -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nusemtl lamp\nf 1 2 3 4\n";

constexpr uint32_t body_samples = 32, body_size = 16;

class BodiesOnAllBackends : public OnEachBackend {
  protected:
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_.path() / name) << text; }
    void write_mesh(const std::string& name, const std::string& text) const {
        write(name, "mtllib all.mtl\nusemtl grey\n" + text);
    }
    Scene load(const std::string& meshes, const std::string& keys = "") const {
        write(
            "all.mtl",
            "newmtl grey\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\nnewmtl glass\nd 0\nNi 1\nnewmtl dense\nd 0\nNi 1.5\n");
        write("a.json", R"({"meshes": [)" + meshes + "]" + keys + "}");
        return load_scene(folder_.path() / "a.json");
    }
    static std::string open(const std::string& file, const std::string& extinction = "1", const std::string& albedo = "0") {
        return R"({"file": ")" + file + R"(", "medium": {"extinction": )" + extinction + R"(, "albedo": )" + albedo +
               R"(, "boundary": "open"}})";
    }
    static RenderSettings settings() {
        return {.width = body_size,
                .height = body_size,
                .samples = body_samples,
                .max_path_length = 100,
                .roulette_start = 1000,
                .estimator = chapter_estimator(chapter_named("media")),
                .backend = GetParam()};
    }
    static void expect_mean(const Scene& scene, double expected, double tolerance = 0) {
        const FilmImage film = render(scene, settings());
        EXPECT_EQ(film.invalid_samples(), 0u);
        double sum = 0;
        for (const FilmPixel& pixel : film.pixels) sum += pixel.sum.g;
        // Each sample is 0 or 1: five standard errors.
        const double count = double{body_size} * body_size * body_samples,
                     error = 5 * std::sqrt(expected * (1 - expected) / count);
        EXPECT_NEAR(sum / count, expected, std::max(error, 1e-5) + tolerance);
    }
    // From straight above, in parallel rays.
    static Scene seen_from_above(Scene scene) {
        scene.camera = {.position = {0.13f, 5000, 0.21f}, .target = {0.13f, 0, 0.21f}, .up = {0, 0, -1}, .vertical_fov = 0.001f};
        return scene;
    }

  private:
    TemporaryFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(Backends, BodiesOnAllBackends, testing::ValuesIn(all_backends), own_backend_name);

TEST_P(BodiesOnAllBackends, PathsKnowTheirMedium) {
    // Open bodies: one on the floor, two in it that share a face and touch its walls and floor, one in one of these, and a bar
    // that runs through several of them.
    write_mesh("media.obj", box({-3, 0, -3}, {3, 4, 3}) + box({-3, 0, -1}, {0, 2, 1}, 1) + box({0, 0, -1}, {3, 2, 1}, 2) +
                                box({-2, 0.5f, -0.5f}, {-1, 1.5f, 0.5f}, 3) + box({-4, 1, 0.25f}, {1, 1.25f, 4}, 4));
    write_mesh("others.obj", "usemtl dense\n" + box({1, 0, 2}, {2, 1, 3}) +
                                 "v -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nusemtl lamp\nf 9 10 11 12\n");
    const Scene scene = load(open("media.obj", "0.2", "0.9") + R"(, {"file": "others.obj"})",
                             R"(, "fog": {"extinction": 0.05, "albedo": 0.9}, "background": {"radiance": 1},
                                "camera": {"position": [6, 5, 9], "target": [0, 1, 0]})");
    const GpuScene gpu_scene(test_device(), scene, Strategy::both,
                             {.light_probe_sampling = true, .microfacets = true, .media = true});
    const auto scene_backend = GetParam()->build(test_device(), gpu_scene);
    Estimator estimator = probe("path_medium");
    estimator.observed = project_folder() / "chapters/13_media/path_trace.glsl";
    estimator.defines = {"SECOND_MESH " + std::to_string(scene.meshes[1].first_triangle) + "u"};
    Renderer renderer(test_device(), *scene_backend, estimator, make_parameters(scene, settings()));
    while (renderer.advance(8)) {
    }
    glm::dvec3 total(0);
    for (const FilmPixel& pixel : renderer.film().read().pixels) total += glm::dvec3(pixel.sum);
    EXPECT_GT(total.y, 4000);
    EXPECT_EQ(total.x, 0) << "of " << total.y;
}

TEST_P(BodiesOnAllBackends, MayTouchWhatIsAroundThem) {
    write_mesh("floor.obj", white_floor);
    write_mesh("a.obj", box({-1, 0, -1}, {1, 1, 1}));
    write_mesh("b.obj", box({-1, 1, -1}, {1, 2, 1}));
    write_mesh("around.obj", box({-2, 0, -2}, {2, 3, 2}));
    write_mesh("table.obj", "usemtl glass\n" + box({-1, 0, -1}, {1, 1, 1}));
    const std::string floor = R"({"file": "floor.obj"}, )", glass = R"({"file": "table.obj"})";
    const auto above = [&](const std::string& meshes) { return seen_from_above(load(floor + meshes)); };
    expect_mean(above(open("a.obj")), std::exp(-1));
    expect_mean(above(open("a.obj") + "," + open("b.obj")), std::exp(-2));
    expect_mean(above(open("b.obj") + "," + open("a.obj")), std::exp(-2));
    expect_mean(above(open("a.obj", "2") + "," + open("around.obj", "0.25")), std::exp(-2.5));
    expect_mean(above(glass), 1);
    expect_mean(above(glass + "," + open("a.obj")), std::exp(-1));
    expect_mean(above(open("a.obj") + "," + glass), std::exp(-1));
}

TEST_P(BodiesOnAllBackends, OverlapByTheirVolumes) {
    write_mesh("floor.obj", white_floor);
    write_mesh("large.obj", box({-2, 1, -2}, {2, 3, 2}));
    write_mesh("small.obj", box({-1, 2, -1}, {1, 4, 1}));
    const std::string floor = R"({"file": "floor.obj"}, )";
    const double expected = std::exp(-1 - 2 * 0.5);
    expect_mean(seen_from_above(load(floor + open("large.obj", "1") + "," + open("small.obj", "0.5"))), expected);
    expect_mean(seen_from_above(load(floor + open("small.obj", "0.5") + "," + open("large.obj", "1"))), expected);
    Scene inside = load(floor + open("small.obj", "0.5") + "," + open("large.obj", "1"));
    inside.camera = {.position = {0.1f, 2.5f, 0.1f}, .target = {0.1f, 0, 0.1f}, .up = {0, 0, -1}, .vertical_fov = 0.001f};
    expect_mean(inside, std::exp(-0.5 * 0.5 - 1));
}

// 40 open bodies between the camera, a matte floor and the sky hide none of its light.
TEST_P(BodiesOnAllBackends, AreCrossedInAnyNumber) {
    write_mesh("floor.obj", "v -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n");
    std::string slabs;
    for (int i = 0; i < 40; ++i)
        slabs += box({-1e4f, 1 + 2.f * static_cast<float>(i), -1e4f}, {1e4f, 2 + 2.f * static_cast<float>(i), 1e4f}, i);
    write_mesh("slabs.obj", slabs);
    Scene scene = load(R"({"file": "floor.obj"}, )" + open("slabs.obj", "1e-12"), R"(, "background": {"radiance": 1})");
    for (const bool is_lamp : {false, true}) {
        if (is_lamp) {
            write_mesh("lamp.obj", "usemtl lamp\nv -1e5 200 -1e5\nv 1e5 200 -1e5\nv 1e5 200 1e5\nv -1e5 200 1e5\nf 1 2 3 4\n");
            scene = load(R"({"file": "floor.obj"}, {"file": "lamp.obj"}, )" + open("slabs.obj", "1e-12"));
        }
        scene = seen_from_above(scene);
        scene.camera.position.y = 100;
        scene.camera.vertical_fov = 0.01f;
        expect_mean(scene, 0.5, 0.01);
    }
}

// In the furnace nothing absorbs, so that every sample is 1, whatever fills the box, and whatever its surface is.
TEST_P(BodiesOnAllBackends, DisappearUnderASky) {
    write_mesh("box.obj", box({-1, -1, -1}, {1, 1, 1}));
    write_mesh("glass.obj", "usemtl dense\n" + box({-1, -1, -1}, {1, 1, 1}));
    write_mesh("far.obj", box({3, 3, 3}, {4, 4, 4}));
    const std::string filled = R"({"file": "glass.obj", "medium": {"extinction": 1, "albedo": 1}})";
    for (const bool has_probe : {false, true})
        for (const std::string& mesh : {open("box.obj", "1", "1"), filled, std::string(R"({"file": "glass.obj"})")}) {
            SCOPED_TRACE(mesh + (has_probe ? ", light probe" : ", sky"));
            Scene scene = load(mesh + ", " + open("far.obj", "0.001", "1"), R"(, "background": {"radiance": 1})");
            if (has_probe) scene.light_probe = Image{8, 4, std::vector<float>(8 * 4 * 3, 1.0f)};
            scene.camera = {.position = {1, 2, 4}, .target = {0, 0, 0}, .vertical_fov = 40};
            expect_mean(scene, 1, has_probe ? 0.02 : 2e-3);  // light samples of a probe vary
        }
}

}  // namespace
}  // namespace lab
