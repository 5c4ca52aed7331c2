// Meshes of degenerate triangles.
#include <cmath>
#include <cstdio>
#include <random>
#include <sstream>

#include "hard_cases/probe.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "unit/test_files.h"

namespace lab {
namespace {

using glm::dvec3;

// Text of an .obj file, triangle by triangle.
class ObjText {
  public:
    ObjText() { text_ << "mtllib m.mtl\n" << std::setprecision(9); }
    void use(const std::string& material) { text_ << "usemtl " << material << '\n'; }
    void add(const dvec3& a, const dvec3& b, const dvec3& c) {
        add_positions(a, b, c);
        text_ << "f -3 -2 -1\n";
    }
    void add(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& normal_a, const dvec3& normal_bc) {
        add_positions(a, b, c);
        for (const dvec3& n : {normal_a, normal_bc}) text_ << "vn " << n.x << ' ' << n.y << ' ' << n.z << '\n';
        text_ << "f -3//-2 -2//-1 -1//-1\n";
    }
    std::string text() const { return text_.str(); }

  private:
    void add_positions(const dvec3& a, const dvec3& b, const dvec3& c) {
        for (const dvec3& p : {a, b, c}) text_ << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    }
    std::ostringstream text_;
};

class BadMeshes : public OnEachBackend {
  protected:
    // A floor under a grey sky and a lamp above it, with `add_bad_ones` in between; the materials "bad" and "bright" emit, too.
    Scene load(const std::function<void(ObjText&)>& add_bad_ones) const {
        const TestFolder folder;
        folder.write("m.mtl",
                     "newmtl floor\nKd 0.8 0.8 0.8\nnewmtl lamp\nKd 0 0 0\nKe 4 4 4\n"
                     "newmtl bad\nKd 0.5 0.5 0.5\nKe 2 2 2\nnewmtl bright\nKd 0.2 0.2 0.2\nKe 9 9 9\n");
        ObjText obj;
        obj.use("floor");
        obj.add({-2, 0, 2}, {2, 0, 2}, {2, 0, -2});
        obj.add({-2, 0, 2}, {2, 0, -2}, {-2, 0, -2});
        obj.use("lamp");
        obj.add({-1, 2, -1}, {1, 2, -1}, {0, 2, 1});
        obj.use("bad");
        add_bad_ones(obj);
        folder.write("m.obj", obj.text());
        return load_scene(folder.write("m.json",
                                       R"({"meshes": [{"file": "m.obj"}], "background": {"radiance": 0.5},
                    "camera": {"position": [0, 1.5, 4], "target": [0, 0.5, 0], "vertical_fov": 40}})"));
    }

    Batches batches(const Scene& scene, const std::string& chapter) const {
        RenderSettings settings{.width = 32, .height = 32, .samples = 3, .max_path_length = 3};
        settings.seed = chapter_seed(chapter);
        settings.estimator = chapter_estimator(chapter);
        settings.backend = GetParam();
        return render_batches(scene, settings, 32);
    }

    // Every point has a normal, the picture equals that of `equivalent` without invalid samples, and light samples and bounces
    // agree.
    void expect_sane(const std::string& what, const Scene& scene, const Scene& equivalent) const {
        EXPECT_NEAR(light_probability_sum(scene), 1, 1e-6) << what;
        const RenderSettings look{.width = 128, .height = 128, .estimator = probe("surface_points"), .backend = GetParam()};
        const glm::dvec3 total = probe_total(scene, look);
        EXPECT_EQ(total.r + total.g, 0) << what << ": points without a normal or position";
        RecordProperty("points_without_a_normal", out_of(total.r, total.b));
        const std::vector<double> expected = batches(equivalent, chapter_named("cosine_sampling")).means(0);
        const double mean = estimate_mean(expected).mean;
        std::vector<Difference> differences;
        for (const std::string& chapter :
             chapters_for(GetParam(), {chapter_named("russian_roulette"), chapter_named("uniform_sampling")}))
            differences.push_back(difference_of(batches(scene, chapter).means(0), expected).relative_to(mean));
        expect_no_difference(what, differences, 0.06, 6);
    }
};
INSTANTIATE_TEST_SUITE_P(Backends, BadMeshes, testing::ValuesIn(all_backends), own_backend_name);

class RandomPoints {
  public:
    double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(generator_); }
    dvec3 point() {
        const double x = uniform(-1, 1), y = uniform(0.2, 1.5);
        return {x, y, uniform(-1, 1)};
    }

  private:
    std::mt19937 generator_{test_seed(1)};
};

const auto nothing = [](ObjText&) {};

TEST_P(BadMeshes, SliversAreNoMoreThanTheyAre) {
    RandomPoints random;
    const Scene scene = load([&](ObjText& obj) {
        for (int i = 0; i < 500; ++i) {
            const double aspect = std::pow(10.0, random.uniform(5, 9));
            const dvec3 a = random.point(), b = random.point(), c = random.point();
            // Some along an axis, where 32-bit coordinates represent even the narrowest.
            const dvec3 u = i % 2 ? dvec3(1, 0, 0) : b - a, v = i % 2 ? dvec3(0, 1, 0) : c - a;
            const dvec3 origin = i % 4 == 1 ? dvec3(0, 0, a.z) : a;
            obj.add(origin, origin + u, origin + 0.3 * u + v / aspect);
        }
    });
    RecordProperty("slivers_left_out", out_of(503.0 - static_cast<double>(scene.triangles.size()), 500));
    expect_sane("slivers", scene, load(nothing));
}

TEST_P(BadMeshes, TrianglesWithoutAreaAndTinyOnesDoNotShow) {
    RandomPoints random;
    const Scene scene = load([&](ObjText& obj) {
        for (int i = 0; i < 200; ++i) {
            const dvec3 a = random.point(), b = random.point(), c = random.point();
            obj.add(a, a, a);
            obj.add(a, b, a);
            obj.add(a, 0.5 * (a + b), b);
            obj.add(a, a + 1e-6 * b, a + 1e-6 * c);
        }
    });
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings.front().find("without area"), std::string::npos);
    expect_sane("no area", scene, load(nothing));
}

const dvec3 corners[] = {{-0.5, 0.5, 0}, {0.5, 0.5, 0.2}, {0, 1.3, 0.1}};

TEST_P(BadMeshes, DuplicatesShineOnce) {
    const auto add = [](ObjText& obj, int count) {
        for (int i = 0; i < count; ++i) obj.add(corners[i % 3], corners[(i + 1) % 3], corners[(i + 2) % 3]);
    };
    expect_sane("duplicates", load([&](ObjText& obj) { add(obj, 4); }), load([&](ObjText& obj) { add(obj, 1); }));
}

TEST_P(BadMeshes, TrianglesInTheSamePlaceThatFaceTheSameWayAreTheFirstThatShines) {
    const auto add = [](ObjText& obj, const std::string& material, size_t first_corner) {
        obj.use(material);
        obj.add(corners[first_corner], corners[(first_corner + 1) % 3], corners[(first_corner + 2) % 3]);
    };
    expect_sane("another emission", load([&](ObjText& obj) { add(obj, "bad", 0), add(obj, "bright", 1); }),
                load([&](ObjText& obj) { add(obj, "bad", 0); }));
    expect_sane("no emission", load([&](ObjText& obj) { add(obj, "floor", 2), add(obj, "bright", 0); }),
                load([&](ObjText& obj) { add(obj, "bright", 0); }));
}

// A double-sided lamp: each side looks as if there were a gap between the two.
TEST_P(BadMeshes, TrianglesInTheSamePlaceThatFaceOppositeWaysAreTwoSides) {
    const dvec3 gap = 1e-3 * glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    const auto load_lamp = [&](const std::string& front, const std::string& back, const dvec3& distance) {
        return load([&](ObjText& obj) {
            obj.use(front);
            obj.add(corners[0], corners[1], corners[2]);
            obj.use(back);
            obj.add(corners[1] - distance, corners[0] - distance, corners[2] - distance);
        });
    };
    for (const auto& [front, back] : {std::pair{"bad", "bad"}, {"bright", "bad"}, {"floor", "bright"}})
        expect_sane(std::string(front) + " and " + back, load_lamp(front, back, dvec3(0)), load_lamp(front, back, gap));
}

TEST_P(BadMeshes, NormalsThatAreZeroOrFaceAwayDoNoHarm) {
    const dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    const auto with_normals = [&](const dvec3& a, const dvec3& bc) {
        return load([&](ObjText& obj) { obj.add(corners[0], corners[1], corners[2], a, bc); });
    };
    const Scene flat = load([](ObjText& obj) { obj.add(corners[0], corners[1], corners[2]); });
    expect_sane("zero normals", with_normals(dvec3(0), dvec3(0)), flat);
    // The front is the side of the vertex normals: a triangle whose normals all face away is flipped.
    expect_sane("all face away", with_normals(-normal, -normal),
                load([](ObjText& obj) { obj.add(corners[0], corners[2], corners[1]); }));
    // Where the interpolated normal faces away nothing is reflected: light samples and bounces still agree.
    const Scene one_away = with_normals(-normal, normal);
    expect_sane("one faces away", one_away, one_away);
}

}  // namespace
}  // namespace lab
