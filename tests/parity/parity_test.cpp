// All backends render the same picture: same random numbers, same paths. Each chapter renders each scene with `compute` and with
// the driver's backends, one sample per pixel, and pixels are compared one by one.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>

#include "files/project_folder.h"
#include "rendering/renderer.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"
#include "tracing/limited_loops.h"

namespace lab {
namespace {

struct TracedImage {
    Image image;
    uint64_t rays;
};

// A scene with the acceleration structure of a backend.
class BackendScene {
  public:
    BackendScene(Backend backend, const Scene& scene, bool samples_probe = false)
        : gpu_scene_(test_device(), scene, Strategy::both, {.light_probe_sampling = samples_probe}),
          scene_backend_(backend->build(test_device(), gpu_scene_)) {}

    // One sample per pixel.
    TracedImage render(const RenderSettings& settings) const {
        Renderer renderer(test_device(), *scene_backend_, settings.estimator, make_parameters(gpu_scene_.scene(), settings));
        while (renderer.advance(1)) {
        }
        return {renderer.film().read().mean(), renderer.rays()};
    }

  private:
    GpuScene gpu_scene_;
    std::unique_ptr<SceneBackend> scene_backend_;
};

struct Limits {
    // Paths count as different if their radiance differs by more than this, relatively, and by more than what rounding leaves of
    // zero where two points of one light lie in its plane.
    double radiance = 1e-3;
    // Largest number of different paths per path segment.
    double fraction = 1e-4;
    // Relative difference of the means beyond what those paths explain.
    double mean = 1e-6;
};

// Expects equal paths within the limits, and means that differ no more than the different paths explain.
void expect_parity(const std::string& what, Backend backend, const TracedImage& expected, const TracedImage& actual,
                   const Limits& limits) {
    size_t different = 0, pixels = expected.image.pixels.size() / 3;
    double difference_sum = 0, difference_square_sum = 0;
    const double sum = std::accumulate(expected.image.pixels.begin(), expected.image.pixels.end(), 0.0);
    const double rest_of_zero = 1e-6 * sum / static_cast<double>(3 * pixels);
    for (size_t pixel = 0; pixel < pixels; ++pixel) {
        bool differs = false;
        double total = 0;
        for (size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
            const double a = expected.image.pixels[i], b = actual.image.pixels[i];
            differs |= std::abs(a - b) > limits.radiance * std::max(std::abs(a), std::abs(b)) + rest_of_zero;
            total += b - a;
        }
        different += differs;
        difference_sum += total;
        difference_square_sum += total * total;
    }
    const double fraction = static_cast<double>(different) / static_cast<double>(std::max<uint64_t>(expected.rays, 1));
    std::printf("[  PARITY  ] %-36s %-8s %zu of %zu paths differ, %.1e a segment, mean differs by %.1e relatively\n",
                what.c_str(), to_string(backend).c_str(), different, pixels, fraction, sum > 0 ? difference_sum / sum : 0.0);
    EXPECT_LE(fraction, limits.fraction) << what;
    // Different ray counts would mean different rays.
    EXPECT_NEAR(static_cast<double>(actual.rays), static_cast<double>(expected.rays),
                10 * limits.fraction * static_cast<double>(expected.rays) + 1);
    // A path that goes another way is as likely to gain as to lose: allows five standard deviations of the sum, plus rounding.
    EXPECT_LE(std::abs(difference_sum), 5 * std::sqrt(difference_square_sum) + limits.mean * sum) << what;
}

// Lavapipe of Mesa 25 supports all backends, so none may be missing where it is used (in continuous integration).
bool must_have_all_backends() {
    const std::string& driver = test_device().description().driver;
    const size_t version = driver.find("llvmpipe Mesa ");
    return version != std::string::npos && std::atoi(driver.c_str() + version + 14) >= 25;
}

Limits limits_of(const Scene& scene, Backend backend) {
    Limits limits;
    // At uv ~ 20 a hit point is rounded to 1/1000 of a texel. Where a dark texel meets a bright one that is some percent of
    // radiance, although the path is the same: one path in a hundred exceeds 10^-3, one in a thousand 10^-2. A path that goes
    // another way nearly always differs by more than a tenth.
    if (!scene.textures.empty()) limits = {.radiance = 0.1, .fraction = 2e-4};
    size_t triangles = 0;
    for (const uint32_t mesh : scene.instance_meshes) triangles += scene.meshes[mesh].triangle_count;
    // Triangles of a thousandth of their distance from the origin have many edges to graze, and `compute` stores their vertices
    // in world space whereas the driver transforms the ray. Barycentrics, and with them the light at a hit, differ by more than
    // rounding.
    if (triangles > 1000000) limits = {.radiance = 1e-2, .fraction = 5e-4};
    // Sine, cosine and arctangent are the CPU's on `native` and the driver's elsewhere. Near a small sun in a light probe,
    // rounding the direction changes radiance by some percent, and equally so in all paths.
    if (backend == native_backend && scene.light_probe)
        limits = {std::max(limits.radiance, 1e-2), std::max(limits.fraction, 2e-4), 1e-4};
    return limits;
}

// The chapters' estimators, with options that enable all of their code.
using Estimators = std::map<std::string, RenderSettings>;
Estimators estimators_of(const std::vector<std::string>& chapters) {
    Estimators estimators;
    for (const std::string& chapter : chapters)
        estimators[chapter] = {.width = 192, .height = 192, .splitting_factor = 2, .estimator = chapter_estimator(chapter)};
    return estimators;
}

Estimators with_every_hit(Estimators all) {
    // The paths are short, since they branch at every hit.
    all["every hit"] = {
        .width = 192, .height = 192, .max_path_length = 3, .splitting_factor = 2, .estimator = every_hit_estimator()};
    return all;
}

// Ends a test whose backend the device lacks.
void require(Backend backend) {
    if (is_supported(backend, test_device().description())) return;
    if (must_have_all_backends()) FAIL() << "this driver is known to have all backends";
    GTEST_SKIP() << "the device lacks " << missing_for(backend, test_device().description()).front();
}

class Parity : public testing::TestWithParam<Backend> {
  protected:
    void SetUp() override { require(GetParam()); }

    void expect_same(const std::string& what, const Scene& scene, uint32_t size, const Limits& limits) {
        const RenderSettings settings{.width = size, .height = size};
        expect_parity(what, GetParam(), BackendScene(compute_backend, scene).render(settings),
                      BackendScene(GetParam(), scene).render(settings), limits);
    }
};

// On a scene file of assets/scenes.
void expect_same_on(const std::filesystem::path& file, Backend backend, const Estimators& estimators) {
    const Scene scene = load_scene(file);
    for (const bool with_probe : {false, true}) {
        const auto samples_so = [&](const auto& e) { return samples_probe(e.second.estimator) == with_probe; };
        if (std::none_of(estimators.begin(), estimators.end(), samples_so)) continue;
        const BackendScene expected(compute_backend, scene, with_probe), actual(backend, scene, with_probe);
        for (const auto& [name, settings] : estimators)
            if (samples_so(std::pair(name, settings)))
                expect_parity(file.stem().string() + ", " + name, backend, expected.render(settings), actual.render(settings),
                              limits_of(scene, backend));
    }
}

// Chapters share the code that traces rays and handles scene features, so a default run has those that follow paths of their own,
// and the last one, on one scene.
TEST_P(Parity, ChaptersWithTheirOwnPaths) {
    std::vector<std::string> chapters = chapters_that([](const std::string& chapter) { return !repeats_another(chapter); });
    chapters.push_back(all_chapters.back());
    expect_same_on(project_folder() / "assets/scenes/cornell_box.json", GetParam(), with_every_hit(estimators_of(chapters)));
}

// In the window, loops that do not end are ended. Others are not changed by that.
TEST_P(Parity, LimitedLoopsFollowTheSamePaths) {
    for (const bool with_probe : {false, true}) {
        const Scene scene = load_shipped_scene("cornell_box.json");
        for (const Backend backend : {compute_backend, GetParam()}) {
            const BackendScene traced(backend, scene, with_probe);
            for (auto [name, settings] : estimators_of({all_chapters.front(), all_chapters.back()})) {
                if (samples_probe(settings.estimator) != with_probe) continue;
                const TracedImage expected = traced.render(settings);
                settings.estimator = with_limited_loops(settings.estimator);
                expect_parity(name + ", limited", backend, expected, traced.render(settings), {});
            }
        }
    }
}

TEST_P(Parity, TurnedStretchedAndMirroredInstances) {
    Scene scene = lit_scene(bumpy_sphere(32));
    place(scene, {{2, 0, 0}, {0, 0.3f, 0.1f}, {0, 0, 1}, {0, 0, 0}});
    place(scene, {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {2, 1, -1}});
    place(scene, {{-1, 0, 0.5f}, {0, 1, 0}, {0, 0, 1}, {-2, 1, -1}});  // mirrored and sheared
    expect_same("transformed instances", scene, 192, {});
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
        expect_same(std::to_string(count) + " instances", scene, 96, {.fraction = 1e-3});
    }
}

TEST_P(Parity, EmptySceneAndSingleTriangle) {
    expect_same("empty scene", lit_scene({}), 32, {.fraction = 0});
    Scene triangle = lit_scene({{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    place(triangle, mat4x3(1));
    expect_same("single triangle", triangle, 64, {.fraction = 1e-3});
}

// More vertices than 16-bit indices can address, and more triangles than some drivers like to number.
TEST_P(Parity, LargeMeshes) {
    for (const uint32_t rings : {260u, 1460u}) {
        Scene scene = lit_scene(bumpy_sphere(rings));
        place(scene, mat4x3(1));
        expect_same(std::to_string(scene.triangles.size()) + " triangles", scene, 96, {.fraction = 1e-3});
    }
}

std::vector<Backend> other_backends() {
    std::vector<Backend> others(std::begin(all_backends), std::end(all_backends));
    std::erase(others, compute_backend);
    return others;
}
INSTANTIATE_TEST_SUITE_P(, Parity, testing::ValuesIn(other_backends()), backend_name);

// A test for each scene, so that an interrupted --all loses little.
class ParityOnScene : public testing::TestWithParam<std::tuple<Backend, std::filesystem::path>> {
  protected:
    void SetUp() override { require(std::get<0>(GetParam())); }
};
TEST_P(ParityOnScene, OfEveryChapter_all) {
    const auto& [backend, file] = GetParam();
    expect_same_on(file, backend, with_every_hit(estimators_of(all_chapters)));
}
INSTANTIATE_TEST_SUITE_P(, ParityOnScene,
                         testing::Combine(testing::ValuesIn(other_backends()),
                                          testing::ValuesIn(sorted_entries(project_folder() / "assets/scenes"))),
                         [](const auto& info) {
                             return to_string(std::get<0>(info.param)) + "_" + std::get<1>(info.param).stem().string();
                         });

}  // namespace
}  // namespace lab
