// The traversal of the bounding volume hierarchy, against brute force and on closed meshes.
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "files/project_folder.h"
#include "support/gpu_test.h"
#include "tracing/gpu_bvh.h"

namespace lab {
namespace {

using glm::dvec3;

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

// A triangle with its number as id.
struct Mesh {
    std::vector<BvhTriangle> triangles;
    void add(const vec3& a, const vec3& b, const vec3& c) {
        const mat3 rows = glm::transpose(mat3(a, b, c));
        const auto id = static_cast<uint32_t>(triangles.size());
        triangles.push_back({rows[0], 7 * id, rows[1], id, rows[2], 0});
    }
    void add_quad(const vec3& corner, const vec3& u, const vec3& v) {
        add(corner, corner + u, corner + u + v);
        add(corner, corner + u + v, corner + v);
    }
};

class Random {
  public:
    explicit Random(uint32_t seed) : generator_(seed) {}
    float uniform(float low, float high) {
        return std::uniform_real_distribution<float>(low, high)(generator_);
    }
    vec3 point() {
        const float x = uniform(-1, 1), y = uniform(-1, 1);
        return {x, y, uniform(-1, 1)};
    }

  private:
    std::mt19937 generator_;
};

// Runs the test shader. `results` is binding 0.
void run_traversal(const Bvh& bvh, const std::vector<std::string>& defines,
                   const std::vector<Binding>& buffers, std::span<const std::byte> push_constants,
                   size_t invocations) {
    const Device& device = test_device();
    const GpuBvh gpu_bvh(device, bvh);
    ShaderSource source{.file = project_folder() / "tests/shaders/bvh_traversal.comp",
                        .defines = gpu_bvh.defines(),
                        .named_includes = {}};
    source.defines.insert(source.defines.end(), defines.begin(), defines.end());
    std::vector<Binding> bindings = gpu_bvh.bindings();
    bindings.insert(bindings.end(), buffers.begin(), buffers.end());
    const ComputeKernel kernel(device, source, bindings, static_cast<uint32_t>(push_constants.size()));
    device.submit([&](const vk::raii::CommandBuffer& commands) {
        kernel.record(commands, push_constants.data(), static_cast<uint32_t>((invocations + 127) / 128));
    });
}

std::vector<TestHit> trace(const Bvh& bvh, const std::vector<TestRay>& rays) {
    std::vector<TestHit> hits(rays.size());
    const auto usage = vk::BufferUsageFlagBits::eStorageBuffer;
    const Buffer results(test_device(), hits.size() * sizeof(TestHit), usage);
    const Buffer inputs(test_device(), std::span<const TestRay>(rays), usage);
    run_traversal(bvh, {}, {storage_binding(0, results), storage_binding(1, inputs)}, {}, rays.size());
    results.read(hits.data(), hits.size() * sizeof(TestHit));
    return hits;
}

// The same tree with boundless boxes, in which a traversal visits every triangle: brute force with the same
// triangle test, so that distances have to be equal to the bit.
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
        const bool is_same = hits[i].is_hit == expected[i].is_hit &&
                             hits[i].distance == expected[i].distance &&
                             hits[i].is_occluded == expected[i].is_hit;
        if (!is_same && differences++ == 0)
            ADD_FAILURE() << "first difference: ray " << i << " hits " << hits[i].is_hit << " at "
                          << hits[i].distance << ", occluded " << hits[i].is_occluded << ", brute force hits "
                          << expected[i].is_hit << " at " << expected[i].distance;
    }
    EXPECT_EQ(differences, 0u) << "of " << rays.size() << " rays";
    EXPECT_GE(static_cast<double>(hit_count), least_hit_fraction * static_cast<double>(rays.size()))
        << "too few hits for the test to mean anything";
}

// Rays of all directions, some of them parallel to an axis or a plane of axes, some of limited length.
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
        // From afar the origin's rounding errors are the larger ones.
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

// Boxes of a grid have their faces where rays run, and rays start on faces.
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
                    // From afar to the same places: there the rounding errors of the origin are the largest.
                    ray.direction = random.point();
                    ray.origin -= 1e4f * ray.direction;
                    rays.push_back(ray);
                }
    const Bvh bvh = build_bvh(mesh.triangles);
    expect_same_hits(bvh, rays, 0.3);

    // Along the plane x = 0, in which faces of the boxes lie: straight on to the faces z = -8.
    rays.clear();
    for (float y_0 = -7.7f; y_0 < 8; y_0 += 2) rays.push_back({{0, y_0, -20}, {0, 0, 1}});
    for (const TestHit& hit : trace(bvh, rays)) {
        EXPECT_TRUE(hit.is_hit);
        EXPECT_EQ(hit.distance, 12);
    }
}

// What a ray does to one triangle, computed in double, with bounds of what rounding to float may make of it.
struct ExactHit {
    bool is_possible = false;  // the ray comes so near that it may be taken for a hit
    bool is_certain = false;   // it stays so far from the edges that it has to be
    double nearest = 0;        // bounds of the distance
    double farthest = 0;
};

ExactHit intersect(const TestRay& ray, const BvhTriangle& triangle) {
    const dvec3 direction(ray.direction), origin(ray.origin);
    const dvec3 size = glm::abs(direction);
    const int z = size.x > size.y && size.x > size.z ? 0 : (size.y > size.z ? 1 : 2);
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    // Vertices in the space in which the ray is the z-axis, z being the ray parameter.
    std::array<dvec3, 3> v;
    double extent = 0;
    for (int i = 0; i < 3; ++i) {
        const dvec3 p = dvec3(triangle.x[i], triangle.y[i], triangle.z[i]) - origin;
        v[i] = {p[x] - direction[x] / direction[z] * p[z], p[y] - direction[y] / direction[z] * p[z],
                p[z] / direction[z]};
        extent = std::max({extent, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    const double tolerance = 8 * 0x1p-24 * extent;
    const auto cross = [](const dvec3& a, const dvec3& b) { return a.x * b.y - a.y * b.x; };
    const dvec3 areas(cross(v[1], v[2]), cross(v[2], v[0]), cross(v[0], v[1]));
    const double area = areas.x + areas.y + areas.z;
    ExactHit hit;
    hit.is_possible = hit.is_certain = true;
    for (int i = 0; i < 3; ++i) {
        const double length = glm::length(glm::dvec2(v[(i + 1) % 3] - v[(i + 2) % 3]));
        // Distance from the edge, positive inside. A triangle seen from its edge has no inside.
        const double inside =
            length > 0 ? areas[i] * (area < 0 ? -1 : 1) / length : -glm::length(glm::dvec2(v[i]));
        hit.is_possible &= inside >= -tolerance;
        hit.is_certain &= inside >= tolerance;
    }
    // A displacement by the tolerance across the ray changes the distance by the slope of the triangle's
    // plane.
    const double low = std::min({v[0].z, v[1].z, v[2].z}), high = std::max({v[0].z, v[1].z, v[2].z});
    const dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
    const double error = tolerance * (2 / size[z] + glm::length(glm::dvec2(normal)) / std::abs(normal.z));
    const double middle = (areas.x * v[0].z + areas.y * v[1].z + areas.z * v[2].z) / area;
    // Both comparisons are false, and the extent of the triangle counts, if these are not numbers.
    hit.nearest = low - tolerance / size[z] > middle - error || !(error < high - low)
                      ? low - 2 * tolerance / size[z]
                      : middle - error;
    hit.farthest = high + tolerance / size[z] < middle + error || !(error < high - low)
                       ? high + 2 * tolerance / size[z]
                       : middle + error;
    return hit;
}

// The bounds come from a computation in double that shares nothing with the shader but the mathematics.
TEST(BvhTraversal, HitsWhatDoublePrecisionHits) {
    for (const float offset : {0.0f, 100.0f}) {
        SCOPED_TRACE(testing::Message() << "offset " << offset);
        const vec3 centre = offset * vec3(1, -0.7f, 0.4f);
        const Mesh mesh = random_mesh(3000, 1, centre);
        const auto rays = random_rays(3000, 1, centre, 5);
        const auto hits = trace(build_bvh(mesh.triangles), rays);
        size_t wrong = 0, certain_hits = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            double earliest = no_limit, latest = rays[i].t_max;
            for (const auto& triangle : mesh.triangles) {
                const ExactHit exact = intersect(rays[i], triangle);
                if (exact.is_possible && exact.farthest > 0) earliest = std::min(earliest, exact.nearest);
                if (exact.is_certain && exact.nearest > 0) latest = std::min(latest, exact.farthest);
            }
            const bool is_certain = latest < rays[i].t_max;
            certain_hits += is_certain;
            bool is_right = hits[i].is_hit == hits[i].is_occluded && (hits[i].is_hit || !is_certain);
            if (hits[i].is_hit) {
                const auto& triangle = mesh.triangles.at(hits[i].triangle);
                const ExactHit exact = intersect(rays[i], triangle);
                const double t = hits[i].distance;
                is_right &= t >= earliest && t <= latest && exact.is_possible && t >= exact.nearest &&
                            t <= exact.farthest && hits[i].instance == 7 * hits[i].triangle;
                const dvec3 weights(1.0 - hits[i].barycentrics.x - hits[i].barycentrics.y,
                                    hits[i].barycentrics);
                const dvec3 position(glm::dot(weights, dvec3(triangle.x)),
                                     glm::dot(weights, dvec3(triangle.y)),
                                     glm::dot(weights, dvec3(triangle.z)));
                const dvec3 on_ray = dvec3(rays[i].origin) + t * dvec3(rays[i].direction);
                is_right &= glm::distance(position, on_ray) <=
                            2 * (exact.farthest - exact.nearest) * glm::length(dvec3(rays[i].direction));
            }
            if (!is_right && wrong++ == 0)
                ADD_FAILURE() << "first wrong ray " << i << ": hit " << hits[i].is_hit << " triangle "
                              << hits[i].triangle << " at " << hits[i].distance << ", expected between "
                              << earliest << " and " << latest;
        }
        EXPECT_EQ(wrong, 0u) << "of " << rays.size() << " rays";
        EXPECT_GT(certain_hits, rays.size() / 5) << "too few hits for the test to mean anything";
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

// A closed surface around a point: `segments` quads around the y-axis in each of `rings`, triangles at the
// poles.
Mesh surface_of_revolution(uint32_t segments, uint32_t rings, const vec3& centre,
                           const std::function<vec3(float theta, float phi)>& surface) {
    const auto vertex = [&](uint32_t ring, uint32_t segment) {
        const float pi = std::numbers::pi_v<float>;
        const float theta = pi * static_cast<float>(ring) / static_cast<float>(rings);
        // Rounded alike on both sides of the seam, and one point at each pole.
        const float phi = 2 * pi * static_cast<float>(segment % segments) / static_cast<float>(segments);
        return centre + (ring % rings == 0 ? surface(ring == 0 ? 0 : pi, 0) : surface(theta, phi));
    };
    Mesh mesh;
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t segment = 0; segment < segments; ++segment) {
            const vec3 a = vertex(ring, segment), b = vertex(ring, segment + 1);
            const vec3 c = vertex(ring + 1, segment + 1), d = vertex(ring + 1, segment);
            if (ring > 0) mesh.add(a, b, c);
            if (ring + 1 < rings) mesh.add(a, c, d);
        }
    return mesh;
}

vec3 spherical(float radius, float theta, float phi) {
    return radius * vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
}

struct AimParameters {
    vec3 centre;
    float half_extent;
    uint32_t triangle_count;
    uint32_t rays;
    uint32_t seed;
};

// Rays from within half_extent of the centre to random vertices, edges and triangles: all must hit something.
void expect_closed(const char* name, const Mesh& mesh, const vec3& centre, float half_extent) {
    constexpr uint32_t invocations = 4096, rays = 90;
    const Buffer buffer(test_device(), std::span<const uint32_t>(std::vector<uint32_t>(3)),
                        vk::BufferUsageFlagBits::eStorageBuffer);
    const AimParameters parameters{centre, half_extent, static_cast<uint32_t>(mesh.triangles.size()), rays,
                                   6};
    run_traversal(build_bvh(mesh.triangles), {"AIM_AT_TRIANGLES"}, {storage_binding(0, buffer)},
                  std::as_bytes(std::span(&parameters, 1)), invocations);
    uint32_t escapes[3];
    buffer.read(escapes, sizeof(escapes));
    std::printf("%s: of %u rays each to vertices, edges and interiors %u, %u and %u escape\n", name,
                invocations * rays / 3, escapes[0], escapes[1], escapes[2]);
    EXPECT_EQ(escapes[0] + escapes[1] + escapes[2], 0u) << name;
}

TEST(BvhTraversal, LetsNoRayOutOfClosedMeshes) {
    const auto bumpy = [](float radius) {
        return [radius](float theta, float phi) {
            const float bump = std::sin(7 * theta) * std::sin(9 * phi) * std::sin(theta);
            return spherical(radius * (1 + 0.1f * bump), theta, phi);
        };
    };
    const vec3 far(148376, 1234, -223423);
    expect_closed("octahedron", surface_of_revolution(4, 2, vec3(0), bumpy(1)), vec3(0), 0.3f);
    expect_closed("bumpy sphere", surface_of_revolution(200, 100, vec3(0), bumpy(1)), vec3(0), 0.4f);
    expect_closed("tiny sphere", surface_of_revolution(200, 100, vec3(0), bumpy(1e-10f)), vec3(0), 4e-11f);
    expect_closed("far sphere", surface_of_revolution(200, 100, far, bumpy(1000)), far, 400);
    expect_closed("slivers", surface_of_revolution(1000, 3, vec3(0), bumpy(1)), vec3(0), 0.2f);
}

}  // namespace
}  // namespace lab
