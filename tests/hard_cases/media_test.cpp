// Media at their limits: from almost none to a million collisions per unit, lobes as narrow as they may be, boundaries seen at
// grazing angles and from a camera on them, and grids that are empty but for one cell. Nothing is brighter than the white sky, no
// sample is invalid, and nothing takes forever.
#include <cmath>

#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

constexpr uint32_t samples = 4, max_path_length = 200;

// A box of side 2 without a surface, filled with a medium, under a white sky.
Scene filled_box(const Medium& medium, const vec3& from, const vec3& to) {
    Scene scene = make_scene({diffuse_material(vec3(0.5f))}, box_sides(vec3(-1), vec3(1), 0, Facing::outwards));
    fill(scene, medium);
    scene.background = vec3(1);
    scene.camera = {.position = from, .target = to, .up = {0.1f, 0.2f, 1}, .vertical_fov = 50};
    return scene;
}

RenderSettings media_settings(const std::string& distances = "SAMPLES_FLIGHTS") {
    RenderSettings settings{.width = 16,
                            .height = 16,
                            .samples = samples,
                            .max_path_length = max_path_length,
                            .roulette_start = no_roulette,
                            .estimator = chapter_estimator(chapter_named("media")),
                            .backend = fastest_backend()};
    settings.estimator.defines = {"DISTANCE_SAMPLING " + distances};
    return settings;
}

// What a pixel shows is at least `low`, with all samples valid.
void expect_between(const Scene& scene, float low) {
    for (const FilmPixel& pixel : render(scene, media_settings()).pixels) {
        ASSERT_EQ(pixel.invalid_count, 0u);
        ASSERT_GE(pixel.sum.r, samples * low);
        ASSERT_LE(pixel.sum.r, samples * 1.0001f);
    }
}

TEST(MediaAtTheirLimits, OfAllExtinctionsAndLobes) {
    for (const float extinction : {1e-6f, 1.0f, 1e3f, 1e6f})
        for (const float anisotropy : {-0.999f, 0.0f, 0.999f})
            for (const float albedo : {0.0f, 1.0f}) {
                SCOPED_TRACE(std::to_string(extinction) + ", " + std::to_string(anisotropy) + ", " + std::to_string(albedo));
                // Thin ones lose nothing if they do not absorb; dense ones keep some paths for more than 200 bounces.
                const bool loses_nothing = extinction <= 1 && albedo == 1;
                expect_between(filled_box(homogeneous_medium(extinction, vec3(albedo), anisotropy), {2, 1, 3}, {0, 0, 0}),
                               loses_nothing ? 0.9999f : 0);
            }
}

TEST(MediaAtTheirLimits, SeenAtGrazingAnglesAndFromTheBoundary) {
    const Medium medium = homogeneous_medium(1, vec3(1), 0.5f);
    for (const float height : {1 + 1e-6f, 1.0f, 1 - 1e-6f}) {
        SCOPED_TRACE(height);
        expect_between(filled_box(medium, {3, 0.1f, height}, {-1, 0.2f, 1}), 0.9999f);
        expect_between(filled_box(medium, {0.3f, 0.1f, height}, {0.2f, 0.3f, -1}), 0.9999f);
    }
}

// Walls that glow, so that light samples look for them along each ray, from a camera on a wall, too. In dense fog most paths are
// longer than 200 bounces.
TEST(MediaAtTheirLimits, SampledByAnglesWhereAllWallsGlow) {
    Scene room = make_scene({diffuse_material(vec3(0), vec3(1))}, box_sides(vec3(-1), vec3(1), 0, Facing::inwards));
    for (const float extinction : {1e-6f, 1.0f, 1e3f, 1e6f})
        for (const float height : {0.3f, 1 - 1e-6f}) {
            SCOPED_TRACE(std::to_string(extinction) + " from " + std::to_string(height));
            room.media = {homogeneous_medium(extinction, vec3(1), 0.5f)};
            room.camera = {.position = {0.1f, 0.2f, height}, .target = {0, 0, -1}, .vertical_fov = 50};
            const FilmImage film = render(room, media_settings("SAMPLES_ANGLES"));
            EXPECT_EQ(film.invalid_samples(), 0u);
            double mean = 0;
            for (const FilmPixel& pixel : film.pixels) mean += double{pixel.sum.r} / samples / 256;
            EXPECT_TRUE(std::isfinite(mean));
            if (extinction <= 1) {
                EXPECT_NEAR(mean, 1, 0.1);
            }
        }
}

TEST(MediaAtTheirLimits, OfGridsThatAreEmptyButForOneCell) {
    for (const float density : {1e-6f, 1.0f, 1e4f}) {
        SCOPED_TRACE(density);
        Medium medium = homogeneous_medium(density == 1e4f ? 0.1f : 1, vec3(1), 0.5f);
        medium.grid_size = uvec3(3);
        medium.largest_density = density;
        medium.low = vec3(-1), medium.high = vec3(1);
        Scene scene = filled_box(medium, {2, 1, 3}, {0, 0, 0});
        scene.densities.assign(27, 0);
        scene.densities[13] = density;
        expect_between(scene, density <= 1 ? 0.9999f : 0);
        scene.camera.position = {0.1f, 0.1f, 0};
        expect_between(scene, density <= 1 ? 0.9999f : 0);
    }
}

}  // namespace
}  // namespace lab
