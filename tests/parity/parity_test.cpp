// The backends give the same picture: same random numbers, same paths. Each chapter renders each scene with
// `compute` and with the backends of the driver, one sample a pixel, and the pixels are compared one by one.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "app/renderer.h"
#include "parity/scenes.h"
#include "support/gpu_test.h"

namespace lab {
namespace {

namespace fs = std::filesystem;

struct Rendering {
    Image image;
    uint64_t rays;
};

Rendering render(Backend backend, const Scene& scene, const fs::path& estimator, uint32_t size) {
    const Device& device = test_device();
    const GpuScene gpu_scene(device, scene);
    const auto structure = build_acceleration_structure(backend, device, gpu_scene);
    const RenderParameters parameters{.camera = make_camera(scene.camera, size, size),
                                      .image_size = {size, size},
                                      .seed_key = seed_key(1),
                                      .first_sample = 0,
                                      .max_path_length = 8,
                                      .only_path_length = -1,
                                      .background = scene.background,
                                      .probe_rotation = scene.probe_rotation};
    Renderer renderer(device, *structure, {estimator}, parameters);
    while (renderer.advance(1)) {
    }
    return {renderer.film().read().mean(), renderer.rays()};
}

// Paths are different where their radiance differs by more than 10^-3 relatively. Their number for each path
// segment is at most `limit`, and the means differ by no more than the different paths explain.
void expect_parity(const std::string& what, Backend backend, const Rendering& expected,
                   const Rendering& actual, double limit) {
    size_t different = 0, pixels = expected.image.pixels.size() / 3;
    double difference_sum = 0, difference_square_sum = 0, sum = 0;
    for (size_t pixel = 0; pixel < pixels; ++pixel) {
        bool differs = false;
        double total = 0;
        for (size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
            const double a = expected.image.pixels[i], b = actual.image.pixels[i];
            differs |= std::abs(a - b) > 1e-3 * std::max(std::abs(a), std::abs(b));
            total += b - a;
            sum += a;
        }
        different += differs;
        difference_sum += total;
        difference_square_sum += total * total;
    }
    const double fraction =
        static_cast<double>(different) / static_cast<double>(std::max<uint64_t>(expected.rays, 1));
    std::printf(
        "[  PARITY  ] %-28s %-8s %zu of %zu paths differ, %.1e a segment, mean differs by %.1e relatively\n",
        what.c_str(), to_string(backend).c_str(), different, pixels, fraction,
        sum > 0 ? difference_sum / sum : 0.0);
    EXPECT_LE(fraction, limit) << what;
    // Rays that are counted differently would be traced differently.
    EXPECT_NEAR(static_cast<double>(actual.rays), static_cast<double>(expected.rays),
                10 * limit * static_cast<double>(expected.rays) + 1);
    // A path that takes another way is as likely to gain as to lose: five standard deviations of the sum, and
    // roundings.
    EXPECT_LE(std::abs(difference_sum), 5 * std::sqrt(difference_square_sum) + 1e-6 * sum) << what;
}

// Lavapipe of Mesa 25 has all backends, so where it is used (in continuous integration) none may be missing.
bool must_have_all_backends() {
    const std::string& driver = test_device().description().driver;
    const size_t version = driver.find("llvmpipe Mesa ");
    return version != std::string::npos && std::atoi(driver.c_str() + version + 14) >= 25;
}

// Largest fraction of different paths for each path segment.
double path_difference_limit(const Scene& scene) {
    // Hit points on textures at uv ~ 20 are rounded to 1/1000 of a texel: at sharp edges that is more than
    // 10^-3 in radiance, while the path stays the same.
    if (!scene.textures.empty()) return 1e-2;
    size_t triangles = 0;
    for (const uint32_t mesh : scene.instance_meshes) triangles += scene.meshes[mesh].triangle_count;
    // Triangles that are a thousandth of their distance from the origin leave many edges to be grazed, and
    // `compute` knows their vertices in world space where the driver transforms the ray.
    return triangles > 1000000 ? 5e-4 : 1e-4;
}

class Parity : public testing::TestWithParam<Backend> {
  protected:
    void SetUp() override {
        if (test_device().description().supports(GetParam())) return;
        if (must_have_all_backends()) FAIL() << "this driver is known to have all backends";
        GTEST_SKIP() << "the device lacks " << test_device().description().missing.at(GetParam()).front();
    }

    void expect_same(const std::string& what, const Scene& scene, uint32_t size, double limit,
                     const fs::path& estimator = project_folder() /
                                                 "chapters/01_uniform_sampling/path_trace.glsl") {
        expect_parity(what, GetParam(), render(Backend::compute, scene, estimator, size),
                      render(GetParam(), scene, estimator, size), limit);
    }
};

TEST_P(Parity, EveryChapterOnEveryScene) {
    for (const auto& chapter : sorted_entries(project_folder() / "chapters"))
        for (const auto& file : sorted_entries(project_folder() / "assets" / "scenes")) {
            const Scene scene = load_scene(file);
            expect_same(chapter.filename().string().substr(0, 2) + " " + file.stem().string(), scene, 192,
                        path_difference_limit(scene), chapter / "path_trace.glsl");
        }
}

TEST_P(Parity, TurnedStretchedAndMirroredInstances) {
    Scene scene = lit_scene(bumpy_sphere(32));
    place(scene, {{2, 0, 0}, {0, 0.3f, 0.1f}, {0, 0, 1}, {0, 0, 0}});
    place(scene, {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {2, 1, -1}});
    place(scene, {{-1, 0, 0.5f}, {0, 1, 0}, {0, 0, 1}, {-2, 1, -1}});  // mirrored and sheared
    expect_same("transformed instances", scene, 192, 1e-4);
}

TEST_P(Parity, ManyInstances) {
    for (const int count : {1, 1000, 100000}) {
        Scene scene = lit_scene(bumpy_sphere(4));
        const int columns = static_cast<int>(std::ceil(std::sqrt(count)));
        for (int i = 0; i < count; ++i) {
            const float scale = 4.0f / static_cast<float>(columns);
            place(scene, {{scale, 0, 0},
                          {0, scale, 0},
                          {0, 0, scale},
                          {scale * static_cast<float>(i % columns - columns / 2),
                           scale * static_cast<float>(i / columns - columns / 2), 0}});
        }
        expect_same(std::to_string(count) + " instances", scene, 96, 1e-3);
    }
}

TEST_P(Parity, EmptySceneAndSingleTriangle) {
    expect_same("empty scene", lit_scene({}), 32, 0);
    Scene triangle = lit_scene({{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    place(triangle, mat4x3(1));
    expect_same("single triangle", triangle, 64, 1e-3);
}

// More vertices than 16-bit indices reach, and more triangles than some drivers like to number.
TEST_P(Parity, LargeMeshes) {
    for (const uint32_t rings : {260u, 1460u}) {
        Scene scene = lit_scene(bumpy_sphere(rings));
        place(scene, mat4x3(1));
        expect_same(std::to_string(scene.triangles.size()) + " triangles", scene, 96, 1e-3);
    }
}

INSTANTIATE_TEST_SUITE_P(, Parity, testing::Values(Backend::pipeline, Backend::query),
                         [](const auto& information) { return to_string(information.param); });

}  // namespace
}  // namespace lab
