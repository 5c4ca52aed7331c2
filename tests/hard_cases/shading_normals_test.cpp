// Shading normals that differ from the triangles' normals.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "hard_cases/probe.h"
#include "support/expect_statistics.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

class ShadingNormals : public OnEachBackend {
  protected:
    static std::vector<std::string> chapters() {
        return chapters_for(
            GetParam(), {chapter_named("cosine_sampling"), chapter_named("uniform_sampling"), chapter_named("russian_roulette")});
    }
};
INSTANTIATE_TEST_SUITE_P(Backends, ShadingNormals, testing::ValuesIn(all_backends), own_backend_name);

RenderSettings settings(const std::string& chapter, Backend backend, uint32_t max_path_length) {
    RenderSettings settings{.width = 32,
                            .height = 32,
                            .samples = 64,
                            .max_path_length = max_path_length,
                            .seed = chapter_seed(chapter) + max_path_length};
    settings.estimator = chapter_estimator(chapter);
    settings.backend = backend;
    return settings;
}

// Under a white sky, a white surface whose shading normal is tilted by τ loses the directions below the triangle: it shows (1 +
// cos τ)/2, seen from where both normals are.
TEST_P(ShadingNormals, TiltedOnesLoseWhatIsBelowTheTriangleAndGainNothing) {
    for (const int degrees : {0, 15, 30, 45, 60}) {
        const double tilt = degrees * pi / 180, expected = 0.5 * (1 + std::cos(tilt));
        Scene scene = make_scene({diffuse_material(vec3(1))}, {{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}});
        scene.normals.assign(scene.positions.size(), vec3(dvec3(std::sin(tilt), 0, std::cos(tilt))));
        scene.background = vec3(1);
        scene.camera = {.position = {0, 0, 1}, .target = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 40};
        for (const std::string& chapter : chapters()) {
            const FilmImage film = render(scene, settings(chapter, GetParam(), 1));
            const MeanEstimate radiance = estimate_mean(pixel_means(film, 0));
            expect_mean(std::to_string(degrees) + " degrees, " + chapter, radiance, expected, 0.05, 15);
            if (chapter == chapters().front())
                RecordProperty("energy_loss_at_" + std::to_string(degrees) + "_degrees", percent(1 - radiance.mean));
        }
    }
}

// The sides of a closed box with tilted normals, the more so the farther from the middle of a side.
Scene furnace_with_normals(double largest_tilt) {
    Scene scene = closed_box(diffuse_material(vec3(0.5f), vec3(1)));
    for (size_t i = 0; i < scene.positions.size(); ++i) {
        const uint32_t first = static_cast<uint32_t>(i / 4 * 4);
        const dvec3 a(scene.positions[first]), b(scene.positions[first + 1]), d(scene.positions[first + 3]);
        const dvec3 normal = glm::normalize(glm::cross(b - a, d - a)), middle = 0.5 * (b + d);
        const dvec3 outwards = glm::normalize(dvec3(scene.positions[i]) - middle);
        scene.normals.emplace_back(std::cos(largest_tilt) * normal + std::sin(largest_tilt) * outwards);
    }
    return scene;
}

TEST_P(ShadingNormals, OfAFurnaceNeverAddEnergy) {
    // In a closed box of albedo 1/2 and emission 1 every point shows at most 2 - 2^-m.
    for (const int degrees : {0, 30, 60, 120}) {
        const Scene scene = furnace_with_normals(degrees * pi / 180);
        for (const std::string& chapter : chapters()) {
            RenderSettings furnace = settings(chapter, GetParam(), 6);
            furnace.samples = 16;
            furnace.strategy = Strategy::bounces;
            const double most = 2 - 1.0 / 64;
            const MeanEstimate radiance = estimate_mean(pixel_means(render(scene, furnace), 0));
            const double energy = radiance.mean / most;
            std::printf("  %d degrees, %s: energy %.4f +- %.4f\n", degrees, chapter.c_str(), energy,
                        radiance.standard_error / most);
            EXPECT_LE(energy, 1 + 6 * radiance.standard_error / most + 1e-6);
            // At least the emission is visible.
            EXPECT_GE(energy, 1 / most - 1e-6);
            if (chapter == chapters().front())
                RecordProperty("furnace_loss_at_" + std::to_string(degrees) + "_degrees", percent(1 - energy));
        }
    }
}

}  // namespace
}  // namespace lab
