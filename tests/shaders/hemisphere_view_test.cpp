// The hemisphere at a shading point, against known values and against the chapters' own estimates there.
#include "inspection/hemisphere_view.h"

#include <cmath>
#include <numbers>

#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

constexpr uint32_t extent = HemisphereView::extent;

// Sets up the view at the first hit of a path through the image.
struct LookAtPoint {
    LookAtPoint(Scene scene_to_use, const RenderSettings& settings)
        : scene(std::move(scene_to_use)),
          gpu_scene(test_device(), scene),
          scene_backend(compute_backend->build(test_device(), gpu_scene)),
          parameters(make_parameters(scene, settings)),
          view(test_device(), *scene_backend, settings.estimator) {
        PathRecorder recorder(test_device(), *scene_backend, settings.estimator, parameters);
        vertex = recorder.record(parameters, parameters.image_size / 2u + settings.height / 4, 0).vertices.at(0);
    }
    HemisphereView::Pictures look(uint32_t samples) {
        view.look_at(vertex, parameters);
        while (view.advance(samples)) {
        }
        return view.pictures();
    }

    Scene scene;
    GpuScene gpu_scene;
    std::unique_ptr<SceneBackend> scene_backend;
    RenderParameters parameters;
    HemisphereView view;
    PathVertex vertex;
};

// Calls check(i, cosine) for the pixels inside the disc, with the index of the red channel and cos θ at the centre.
template <typename Check>
void for_each_inner_pixel(const Check& check) {
    for (uint32_t y = 0; y < extent; ++y)
        for (uint32_t x = 0; x < extent; ++x) {
            const double s = (2 * x + 1.0) / extent - 1, t = (2 * y + 1.0) / extent - 1, square = s * s + t * t;
            if (square < 0.95) check(3 * (size_t{y} * extent + x), 1 - square);
        }
}

TEST(HemisphereView, ShowsKnownFactorsInAFurnace) {
    RenderSettings settings{.max_path_length = 1};
    settings.estimator = chapter_estimator(chapter_named("cosine_sampling"));
    LookAtPoint setup(closed_box(diffuse_material(vec3(0.8f, 0.5f, 0.2f), vec3(3))), settings);
    const auto pictures = setup.look(4);
    uint32_t pixels = 0;
    for_each_inner_pixel([&](size_t i, double cosine) {
        ++pixels;
        EXPECT_EQ(pictures.incoming_radiance.pixels[i], 3);
        EXPECT_NEAR(pictures.brdf.pixels[i], 0.8 / std::numbers::pi, 1e-6);
        EXPECT_NEAR(pictures.brdf.pixels[i + 2], 0.2 / std::numbers::pi, 1e-6);
        EXPECT_NEAR(pictures.cosine.pixels[i], cosine, 0.025);  // the cosine's variation within a pixel
    });
    EXPECT_GT(pixels, 11000u);
    // ∫ L_i ρ n·ω dω = L_i albedo.
    const vec3 reflected = pictures.reflected_radiance();
    EXPECT_NEAR(reflected.r, 2.4, 0.01);
    EXPECT_NEAR(reflected.g, 1.5, 0.01);
    EXPECT_NEAR(reflected.b, 0.6, 0.01);
}

TEST(HemisphereView, ShowsTheSkyUpwards) {
    // A floor under a sky, with a bright wall behind it, seen by a camera that looks along -z.
    Scene scene = make_scene({diffuse_material(vec3(0.5f)), diffuse_material(vec3(0), vec3(5))},
                             {{{-9, 0, 9}, {18, 0, 0}, {0, 0, -18}, 0}, {{-9, 0, -9}, {18, 0, 0}, {0, 9, 0}, 1}});
    scene.camera = {.position = {0, 2, 4}, .target = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 40};
    scene.background = vec3(1);
    RenderSettings settings{.max_path_length = 3};
    LookAtPoint setup(std::move(scene), settings);
    EXPECT_NEAR(setup.vertex.normal.y, 1, 1e-6f);
    const auto pictures = setup.look(1);
    const auto at = [&](uint32_t x, uint32_t y) { return pictures.incoming_radiance.pixels[3 * (size_t{y} * extent + x)]; };
    EXPECT_EQ(at(extent / 2, extent / 2), 1);   // straight up
    EXPECT_EQ(at(extent / 2, extent / 16), 5);  // up in the picture is far away
    EXPECT_EQ(at(extent / 2, 15 * extent / 16), 1);
    EXPECT_EQ(at(extent / 16, extent / 2), 1);
    EXPECT_EQ(at(0, 0), 0);  // outside the disc
}

class HemisphereOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(, HemisphereOf,
                         testing::Values(chapter_named("cosine_sampling"), chapter_named("next_event_estimation"),
                                         chapter_named("russian_roulette")),
                         chapter_name);

TEST_P(HemisphereOf, IntegratesToWhatTheChapterReflects) {
    RenderSettings settings{.width = 16, .height = 16, .max_path_length = 4};
    settings.estimator = chapter_estimator(GetParam());
    Scene scene = load_shipped_scene(samples_lights(GetParam()) ? "cornell_box.json" : "instances.json");
    LookAtPoint setup(std::move(scene), settings);
    // A camera at the same place whose whole image shows that point.
    RenderParameters narrow = setup.parameters;
    narrow.camera.forward = setup.vertex.direction;
    narrow.camera.right *= 1e-5f;
    narrow.camera.up *= 1e-5f;
    Renderer renderer(test_device(), *setup.scene_backend, settings.estimator, narrow);
    std::vector<double> integrals, estimates;
    for (uint32_t batch = 0; batch < 16; ++batch) {
        setup.parameters.seed_key = seed_key(test_seed(chapter_seed(GetParam()) + batch));
        integrals.push_back(setup.look(1).reflected_radiance().g);
        narrow.seed_key = seed_key(test_seed((batch << 16) + 77));
        renderer.restart(narrow);
        while (renderer.advance(64)) {
        }
        estimates.push_back(renderer.film().read().mean_radiance()[1]);
    }
    const Difference difference = difference_of(integrals, estimates).relative_to(estimate_mean(estimates).mean);
    expect_no_difference("reflected radiance", std::span(&difference, 1), 0.05);
}

}  // namespace
}  // namespace lab
