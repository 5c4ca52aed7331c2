// Which body is where: random bodies that are nested, touch, share faces, are mirrored or parts of one mesh, compared with what
// their boxes say; and surfaces that lie in one place.
#include "scene/bodies.h"

#include <cmath>
#include <map>
#include <random>

#include "support/obj_text.h"
#include "test_files.h"

namespace lab {
namespace {

using glm::dvec3;
using testing::IsSubstring;

bool contains(const Solid& solid, const dvec3& point) {
    return std::ranges::all_of(solid.faces, [&](const std::vector<int>& face) {
        const auto corner = [&](size_t i) { return dvec3(solid.corners[static_cast<size_t>(face[i])]); };
        return glm::dot(point - corner(0), glm::cross(corner(1) - corner(0), corner(2) - corner(0))) < 0;
    });
}

// Random boxes and balls: each box is divided into bodies that touch it and each other, or contains smaller ones that do not.
class RandomBodies {
  public:
    explicit RandomBodies(unsigned seed) : random_(seed) { divide({vec3(-8), vec3(8)}, 3); }

    std::vector<Solid> solids;
    std::vector<float> volumes;

  private:
    struct Box {
        vec3 low, high;
    };
    int choose(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }

    void divide(const Box& box, int depth) {
        const float margin = choose(2) == 0 ? 0.25f : 0;
        const Box inner{box.low + margin, box.high - margin};
        const vec3 size = inner.high - inner.low;
        const bool is_ball = depth < 3 && choose(3) == 0;
        solids.push_back((is_ball ? make_ball : make_box)(inner.low, inner.high));
        volumes.push_back(size.x * size.y * size.z * (is_ball ? 0.5f : 1));  // a ball has less, and contains no others
        if (is_ball || depth == 0 || glm::any(glm::lessThan(size, vec3(1.5f)))) return;
        const int axis = choose(3);
        Box half = inner;
        half.high[axis] = 0.5f * (inner.low[axis] + inner.high[axis]);
        divide(half, depth - 1);
        half = {inner.low, inner.high};
        half.low[axis] = 0.5f * (inner.low[axis] + inner.high[axis]);
        if (choose(3) > 0) divide(half, depth - 1);
    }

    std::mt19937 random_;
};

// The medium around a point, as the next boundary on a ray has it, in double precision.
uint32_t medium_by_ray(const Scene& scene, const dvec3& origin, const dvec3& direction) {
    double nearest = INFINITY;
    uint32_t medium = 0;
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance)
        for (const uint32_t triangle : scene.mesh_of(instance).triangles()) {
            const dvec3 a = world_corner(scene, instance, triangle, 0), b = world_corner(scene, instance, triangle, 1),
                        c = world_corner(scene, instance, triangle, 2);
            dvec3 normal = glm::cross(b - a, c - a);
            const double t = glm::dot(a - origin, normal) / glm::dot(direction, normal);
            const dvec3 point = origin + t * direction;
            const auto is_left_of = [&](const dvec3& p, const dvec3& q) {
                return glm::dot(normal, glm::cross(q - p, point - p)) >= 0;
            };
            if (!(t > 0 && t < nearest && is_left_of(a, b) && is_left_of(b, c) && is_left_of(c, a))) continue;
            nearest = t;
            if (glm::determinant(glm::dmat3(mat3(scene.instances[instance].object_to_world))) < 0) normal = -normal;
            const Boundary boundary = scene.boundaries.at(scene.boundary_places.at(triangle) +
                                                          scene.boundary_places.at(scene.triangles.size() + instance));
            medium = glm::dot(normal, direction) < 0 ? boundary.before : boundary.behind;
        }
    return medium;
}

class Bodies : public testing::Test {
  protected:
    Scene load(const std::string& meshes, const std::string& keys = "") const {
        folder.write("all.mtl",
                     "newmtl grey\nKd 0.5 0.5 0.5\nnewmtl red\nKd 0.5 0 0\nnewmtl lamp\nKe 1 1 1\nnewmtl glass\nd 0\nNi 1.5\n");
        return load_scene(folder.write("a.json", R"({"meshes": [)" + meshes + "]" + keys + "}"));
    }
    void write(const std::string& name, const std::string& text, const std::string& material = "grey") const {
        folder.write(name, "mtllib all.mtl\nusemtl " + material + "\n" + text);
    }
    static std::string open(const std::string& file, double extinction = 1, const std::string& keys = "") {
        return R"({"file": ")" + file + R"(", "medium": {"extinction": )" + std::to_string(extinction) +
               R"(, "albedo": 0, "boundary": "open"})" + keys + "}";
    }

    TestFolder folder;
};

TEST_F(Bodies, AreTheSmallestAroundAPoint) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    size_t points = 0;
    for (unsigned seed = 0; points < 100'000; ++seed) {
        const RandomBodies bodies(seed);
        const std::vector<Solid>& solids = bodies.solids;
        // In any order; some are mirrored, some inside out, and every second scene has all in one mesh.
        std::vector<size_t> order(solids.size());
        for (size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::ranges::shuffle(order, random);
        std::string meshes, together;
        int corner_count = 0;
        const bool is_one_mesh = seed % 2 == 1;
        for (size_t k = 0; k < order.size(); ++k) {
            const Solid& solid = solids[order[k]];
            const std::string file = "body" + std::to_string(k) + ".obj";
            const bool is_inside_out = !is_one_mesh && random() % 4 == 0, is_mirrored = random() % 4 == 0;
            Solid placed = solid;
            for (vec3& corner : placed.corners) corner.x *= is_mirrored ? -1 : 1;
            write(file, obj_text(placed, 1, is_inside_out != is_mirrored));
            together += obj_text(solid, corner_count + 1);
            corner_count += static_cast<int>(solid.corners.size());
            meshes +=
                (k > 0 ? "," : "") + open(file, static_cast<double>(order[k] + 1), is_mirrored ? R"(, "scale": [-1, 1, 1])" : "");
        }
        write("together.obj", together);
        const Scene scene = load(is_one_mesh ? open("together.obj") : meshes);
        ASSERT_EQ(find_bodies(scene).size(), solids.size()) << seed;
        ASSERT_TRUE(scene.warnings.empty()) << scene.warnings[0];
        // The larger the index of a medium, the smaller its body: so volumes tell bodies of one mesh apart, as far as they
        // differ.
        for (int i = 0; i < 400; ++i, ++points) {
            // A point beside a face, which others may touch.
            const Solid& solid = solids[random() % solids.size()];
            const std::vector<int>& face = solid.faces[random() % solid.faces.size()];
            const auto corner = [&](size_t k) { return dvec3(solid.corners[static_cast<size_t>(face[k])]); };
            const double u = std::sqrt(uniform(random)), v = uniform(random);
            const dvec3 edge_1 = corner(1) - corner(0), edge_2 = corner(face.size() - 1) - corner(0);
            const dvec3 normal = glm::normalize(glm::cross(edge_1, edge_2));
            const dvec3 point = corner(0) + u * (1 - v) * edge_1 + u * v * edge_2 + (random() % 2 ? 0.02 : -0.02) * normal;
            const dvec3 direction(uniform(random) - 0.5, uniform(random) - 0.5, uniform(random) - 0.5);
            std::optional<size_t> expected;
            for (size_t k = 0; k < solids.size(); ++k)
                if (contains(solids[k], point) && (!expected || bodies.volumes[k] <= bodies.volumes[*expected])) expected = k;
            const uint32_t medium = medium_by_ray(scene, point, direction);
            if (is_one_mesh)
                ASSERT_EQ(medium == 0, !expected) << seed << ", " << i;
            else
                ASSERT_EQ(scene.media.at(medium).extinction, expected ? static_cast<float>(*expected + 1) : 0)
                    << seed << ", " << i;
        }
    }
    RecordProperty("points", static_cast<int>(points));
}

TEST_F(Bodies, OpaqueTrianglesBoundNothing) {
    // A room with its walls inwards, a vase of glass and an opaque box, all in one mesh.
    write("room.obj", box_text(vec3(-5), vec3(5), 1, true) + box_text(vec3(2), vec3(3), 9) + "usemtl glass\n" +
                          box_text(vec3(-1), vec3(1), 17));
    write("milk.obj", box_text(vec3(-0.5f), vec3(0.5f), 1), "glass");
    const Scene scene = load(R"({"file": "room.obj"}, {"file": "milk.obj", "medium": {"extinction": 3, "albedo": 1}})",
                             R"(, "fog": {"extinction": 7, "albedo": 1})");
    ASSERT_EQ(scene.media.size(), 3u);
    EXPECT_EQ(scene.media[1].extinction, 0) << "clear glass";
    EXPECT_EQ(scene.media[2].extinction, 3);
    const auto extinction_at = [&](const dvec3& point) {
        return scene.media[medium_by_ray(scene, point, {0.1, -0.2, -1})].extinction;
    };
    EXPECT_EQ(extinction_at({0.1, 0.2, 4}), 7);
    EXPECT_EQ(extinction_at({0.1, 0.2, 0.9}), 0);
    EXPECT_EQ(extinction_at({0.1, 0.2, 0}), 3);
}

TEST_F(Bodies, ACavityInGlassIsFilledByWhatIsAroundTheGlass) {
    write("hollow.obj", box_text(vec3(-2), vec3(2), 1) + box_text(vec3(-1), vec3(1), 9, true), "glass");
    const Scene scene = load(R"({"file": "hollow.obj"})", R"(, "fog": {"extinction": 7, "albedo": 1})");
    const auto extinction_at = [&](double z) { return scene.media[medium_by_ray(scene, {0.1, 0.2, z}, {0, 0, 1})].extinction; };
    EXPECT_EQ(extinction_at(-3), 7);
    EXPECT_EQ(extinction_at(-1.5), 0);
    EXPECT_EQ(extinction_at(0), 7);
    EXPECT_EQ(extinction_at(1.5), 0);
    EXPECT_TRUE(std::ranges::none_of(scene.warnings, [](const std::string& note) { return note.find("turned") != note.npos; }));
}

TEST_F(Bodies, InsideOutGlassIsTurnedAround) {
    write("a.obj", box_text(vec3(-1), vec3(1), 1, true), "glass");
    const Scene scene = load(R"({"file": "a.obj"}, {"file": "a.obj", "translation": [5, 0, 0]})");
    ASSERT_EQ(scene.warnings.size(), 2u);
    EXPECT_PRED_FORMAT2(IsSubstring, "face inwards: turned around", scene.warnings[0]);
    for (const Body& body : find_bodies(scene)) EXPECT_NEAR(body.volume, 8, 1e-6);
}

TEST_F(Bodies, HolesAndOverlapsAreNoted) {
    const std::string box = box_text(vec3(0), vec3(2), 1);
    write("hole.obj", box.substr(0, box.rfind("f ")));
    write("box.obj", box);
    write("bar.obj", box_text({0.5f, 0.5f, -1}, {1, 1, 5}));
    auto notes = load(open("hole.obj")).warnings;
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_PRED_FORMAT2(IsSubstring, "hole.obj: the boundary of its medium is not closed: it has 4 open edges", notes[0]);
    notes = load(open("box.obj") + "," + open("bar.obj")).warnings;
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_PRED_FORMAT2(IsSubstring, "overlaps with", notes[0]);
    EXPECT_PRED_FORMAT2(IsSubstring, "smaller one, ", notes[0]);
    EXPECT_TRUE(notes[0].ends_with("bar.obj")) << notes[0];
    for (const char* other : {"[1, 1, 1]", "[1, 0, 0]"}) {
        notes = load(open("box.obj") + "," + open("box.obj", 1, R"(, "translation": )" + std::string(other))).warnings;
        ASSERT_EQ(notes.size(), 1u) << other;
        EXPECT_PRED_FORMAT2(IsSubstring, "overlaps with", notes[0]);
    }
    for (const char* other : {"[2, 0, 0]", "[2, 2, 0]", "[2, 2, 2]", "[2, 1, 1]", "[3, 0, 0]"}) {
        notes = load(open("box.obj") + "," + open("box.obj", 1, R"(, "translation": )" + std::string(other))).warnings;
        EXPECT_TRUE(notes.empty()) << other << notes[0];
    }
}

// The heights of all corners of an instance.
std::vector<float> heights(const Scene& scene, uint32_t instance) {
    std::vector<float> found;
    for (const uint32_t triangle : scene.mesh_of(instance).triangles())
        for (int i = 0; i < 3; ++i) found.push_back(static_cast<float>(world_corner(scene, instance, triangle, i).y));
    std::ranges::sort(found);
    return found;
}

const std::string floor_text = "v -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4\n";
const std::string rug_text = "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nf 1 2 3 4\n",
                  rug_below_text = "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nf 4 3 2 1\n";

TEST_F(Bodies, ThatTouchSomethingMoveInwards) {
    write("floor.obj", floor_text);
    write("box.obj", box_text(vec3(0), vec3(2), 1), "glass");
    const Scene scene = load(R"({"file": "box.obj"}, {"file": "floor.obj"}, {"file": "box.obj", "translation": [0, 3, 0]})");
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_GT(heights(scene, 0).front(), 0);
    EXPECT_LT(heights(scene, 0).front(), 1e-3);
    EXPECT_EQ(heights(scene, 1).back(), 0) << "what is opaque stays";
    EXPECT_EQ(heights(scene, 2).front(), 3) << "another placement of the mesh stays";
}

TEST_F(Bodies, OfWhichOneFillsTheOtherLieInside) {
    write("box.obj", box_text(vec3(0), vec3(2), 1), "glass");
    for (const bool is_first : {false, true}) {
        const std::string glass = R"({"file": "box.obj"})", medium = open("box.obj", 3);
        const Scene scene = load(is_first ? medium + "," + glass : glass + "," + medium);
        EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
        const uint32_t outer = is_first ? 1 : 0;
        EXPECT_EQ(heights(scene, outer).front(), 0);
        EXPECT_GT(heights(scene, 1 - outer).front(), 0);
        EXPECT_LT(heights(scene, 1 - outer).back(), 2);
        EXPECT_EQ(scene.media.at(2).extinction, 3);
    }
}

TEST_F(Bodies, LampsInThePlaneOfSomethingMoveToTheirFront) {
    write("floor.obj", floor_text);
    write("up.obj", rug_text, "lamp");
    write("down.obj", rug_below_text, "lamp");
    const std::string floor = R"({"file": "floor.obj"})", up = R"({"file": "up.obj"})", down = R"({"file": "down.obj"})";
    const Scene scene = load(up + "," + floor + "," + down);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
    EXPECT_GT(heights(scene, 0).front(), 0);
    EXPECT_LT(heights(scene, 2).back(), 0);
    EXPECT_EQ(heights(scene, 1).back(), 0);
}

TEST_F(Bodies, OpaqueSurfacesInOnePlaneAreShownInTheirOrder) {
    write("floor.obj", floor_text);
    write("rug.obj", rug_text, "red");
    write("grey_rug.obj", rug_text);
    write("crate.obj", box_text(vec3(0), vec3(2), 1), "red");
    const std::string floor = R"({"file": "floor.obj"})", rug = R"({"file": "rug.obj"})";
    const Scene scene = load(floor + "," + rug);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_PRED_FORMAT2(IsSubstring, "rug.obj: lies in the plane of", scene.warnings[0]);
    EXPECT_GT(heights(scene, 1).front(), 0);
    const Scene crate = load(floor + R"(, {"file": "crate.obj"})");
    EXPECT_TRUE(crate.warnings.empty()) << "it stands on the floor: what is in one plane faces opposite ways";
    EXPECT_EQ(heights(crate, 1).front(), 0);
}

}  // namespace
}  // namespace lab
