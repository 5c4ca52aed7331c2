// Traversal of the bounding volume hierarchy against brute force. The hard cases shoot rays at closed meshes, and Parity compares
// the triangle test with the driver's.
#include <cmath>
#include <limits>
#include <random>

#include "files/project_folder.h"
#include "support/gpu_test.h"
#include "tracing/gpu_bvh.h"
#include "unit/bvh_triangles.h"

namespace lab {
namespace {

constexpr float no_limit = std::numeric_limits<float>::max();

struct TestRay {
    vec3 origin;
    vec3 direction;
    float t_max = no_limit;
};

struct TestHit {
    uint32_t is_hit;
    uint32_t is_occluded;
    uint32_t instance;
    uint32_t triangle;
    vec2 barycentrics;
    float distance;
};

// Triangles with their indices as ids.
struct Mesh {
    std::vector<BvhTriangle> triangles;
    void add(const vec3& a, const vec3& b, const vec3& c) { triangles.push_back(make_triangle(a, b, c, triangles.size())); }
    void add_quad(const vec3& corner, const vec3& u, const vec3& v) {
        add(corner, corner + u, corner + u + v);
        add(corner, corner + u + v, corner + v);
    }
};

class Random {
  public:
    explicit Random(uint32_t seed) : generator_(seed) {}
    float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(generator_); }
    vec3 point() {
        const float x = uniform(-1, 1), y = uniform(-1, 1);
        return {x, y, uniform(-1, 1)};
    }

  private:
    std::mt19937 generator_;
};

std::vector<TestHit> trace(const Bvh& bvh, const std::vector<TestRay>& rays) {
    const Device& device = test_device();
    const GpuBvh gpu_bvh(device, bvh);
    const auto usage = vk::BufferUsageFlagBits::eStorageBuffer;
    std::vector<TestHit> hits(rays.size());
    const Buffer results(device, hits.size() * sizeof(TestHit), usage);
    const Buffer inputs(device, std::span<const TestRay>(rays), usage);
    std::vector<Binding> bindings = gpu_bvh.bindings();
    bindings.insert(bindings.end(), {storage_binding(0, results), storage_binding(1, inputs)});
    const ShaderSource source{
        .file = project_folder() / "tests/shaders/bvh_traversal.comp", .defines = gpu_bvh.defines(), .named_includes = {}};
    const ComputeKernel kernel(device, source, bindings, 0);
    device.submit([&](const vk::raii::CommandBuffer& commands) {
        kernel.record(commands, nullptr, static_cast<uint32_t>((rays.size() + 127) / 128));
    });
    results.read(hits.data(), hits.size() * sizeof(TestHit));
    return hits;
}

// The same tree with infinite boxes, so that a traversal visits every triangle: brute force with the same triangle test, so
// distances must be equal to the bit.
Bvh without_boxes(Bvh bvh) {
    for (auto& node : bvh.nodes)
        for (auto& axis : node.bounds)
            for (size_t child = 0; child < 4; ++child)
                if (node.children[child] != 0) axis[0][child] = -1e30f, axis[1][child] = 1e30f;
    return bvh;
}

void expect_same_hits(const Bvh& bvh, const std::vector<TestRay>& rays, double least_hit_fraction) {
    const auto hits = trace(bvh, rays);
    const auto expected = trace(without_boxes(bvh), rays);
    size_t differences = 0, hit_count = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        hit_count += expected[i].is_hit;
        const bool is_same = hits[i].is_hit == expected[i].is_hit && hits[i].distance == expected[i].distance &&
                             hits[i].is_occluded == expected[i].is_hit;
        if (!is_same && differences++ == 0)
            ADD_FAILURE() << "first difference: ray " << i << " hits " << hits[i].is_hit << " at " << hits[i].distance
                          << ", occluded " << hits[i].is_occluded << ", brute force hits " << expected[i].is_hit << " at "
                          << expected[i].distance;
    }
    EXPECT_EQ(differences, 0u) << "of " << rays.size() << " rays";
    EXPECT_GE(static_cast<double>(hit_count), least_hit_fraction * static_cast<double>(rays.size()))
        << "too few hits for the test to mean anything";
}

// Rays in all directions, some parallel to an axis or a coordinate plane, some of limited length.
std::vector<TestRay> random_rays(size_t count, float scale, const vec3& centre, uint32_t seed) {
    Random random(seed);
    std::vector<TestRay> rays;
    for (size_t i = 0; i < count; ++i) {
        TestRay ray{centre + scale * random.point(), random.point(), no_limit};
        if (i % 4 == 1) ray.direction[static_cast<int>(i / 4 % 3)] = i % 8 == 1 ? 0.0f : -0.0f;
        if (i % 4 == 2) {
            const auto axis = static_cast<int>(i / 4 % 3);
            const float sign = ray.direction[axis] < 0 ? -1.0f : 1.0f;
            ray.direction = vec3(0);
            ray.direction[axis] = sign;
        }
        // From afar the rounding errors of the origin dominate.
        if (i % 5 == 1) {
            ray.direction = ray.origin - centre;
            ray.origin = centre - 1e4f * ray.direction + 0.5f * scale * random.point();
            ray.direction /= scale;
        } else if (i % 3 == 0) {
            ray.t_max = scale * random.uniform(0, 1);
        }
        rays.push_back(ray);
    }
    return rays;
}

// Triangles of many shapes: ordinary ones, slivers, duplicates, and degenerate ones that are lines or points.
Mesh random_mesh(size_t count, float scale, const vec3& centre) {
    Random random(2);
    Mesh mesh;
    while (mesh.triangles.size() < count) {
        const vec3 a = random.point(), u = 0.5f * random.point(), v = 0.5f * random.point();
        const auto add = [&](const vec3& b, const vec3& c) {
            mesh.add(centre + scale * a, centre + scale * b, centre + scale * c);
        };
        add(a + u, a + v);
        add(a + u, a + v);
        add(a + u, a + u + 1e-4f * v);
        add(a + u, a + u + 1e-7f * v);
        add(a + u, a + 0.5f * u);
        add(a, a);
    }
    return mesh;
}

TEST(BvhTraversal, FindsTheHitsOfBruteForce) {
    for (const float scale : {1e-12f, 1.0f, 1e12f})
        for (const float offset : {0.0f, 1.0f, 1000.0f}) {
            SCOPED_TRACE(testing::Message() << "scale " << scale << ", offset " << offset);
            const vec3 centre = scale * offset * vec3(1, -0.7f, 0.4f);
            const Bvh bvh = build_bvh(random_mesh(3000, scale, centre).triangles);
            expect_same_hits(bvh, random_rays(5000, scale, centre, 3), 0.2);
        }
}

// In a grid, box faces lie exactly where rays run, and rays start on faces.
TEST(BvhTraversal, HitsBoxesAlongTheirFaces) {
    Mesh mesh;
    const vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    for (int i = 0; i < 512; ++i) {
        const vec3 corner = 2.0f * vec3(i % 8, i / 8 % 8, i / 64) - 8.0f;
        mesh.add_quad(corner, x, y), mesh.add_quad(corner + z, x, y);
        mesh.add_quad(corner, y, z), mesh.add_quad(corner + x, y, z);
        mesh.add_quad(corner, z, x), mesh.add_quad(corner + y, z, x);
    }
    Random random(4);
    std::vector<TestRay> rays;
    for (int axis = 0; axis < 3; ++axis)
        for (const float direction : {-1.0f, 1.0f})
            for (const float zero : {-0.0f, 0.0f})
                for (int i = 0; i < 500; ++i) {
                    TestRay ray{glm::round(9.0f * random.point()), vec3(zero), no_limit};
                    ray.direction[axis] = direction;
                    // Half of the rays run along a face, the others along an edge of the grid.
                    if (i % 2) ray.origin[(axis + 1) % 3] += random.uniform(0, 1);
                    rays.push_back(ray);
                    // From afar to the same places, where the rounding errors of the origin are largest.
                    ray.direction = random.point();
                    ray.origin -= 1e4f * ray.direction;
                    rays.push_back(ray);
                }
    const Bvh bvh = build_bvh(mesh.triangles);
    expect_same_hits(bvh, rays, 0.3);

    // In the plane x = 0, which contains box faces: straight to the faces z = -8.
    rays.clear();
    for (float y_0 = -7.7f; y_0 < 8; y_0 += 2) rays.push_back({{0, y_0, -20}, {0, 0, 1}});
    for (const TestHit& hit : trace(bvh, rays)) {
        EXPECT_TRUE(hit.is_hit);
        EXPECT_EQ(hit.distance, 12);
    }
}

TEST(BvhTraversal, WorksWithoutTrianglesAndWithOne) {
    const TestRay ray{{0.25f, 0.25f, -2}, {0, 0, 1}};
    EXPECT_FALSE(trace(build_bvh({}), {ray}).front().is_hit);
    Mesh mesh;
    mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const Bvh bvh = build_bvh(mesh.triangles);
    const auto hits = trace(bvh, {ray,
                                  {ray.origin, ray.direction, 2},
                                  {ray.origin, ray.direction, 2.0001f},
                                  {ray.origin, -ray.direction},
                                  {{0.25f, 0.25f, 0}, {0, 0, 1}}});
    EXPECT_EQ(hits[0].distance, 2);
    EXPECT_EQ(hits[0].barycentrics, vec2(0.25f));
    const std::vector<bool> expected{true, false, true, false, false};
    for (size_t i = 0; i < hits.size(); ++i) {
        EXPECT_EQ(hits[i].is_hit, expected[i]) << "ray " << i;
        EXPECT_EQ(hits[i].is_occluded, expected[i]) << "ray " << i;
    }
}

}  // namespace
}  // namespace lab
