// Chapter 6 where the radiance behind and inside dielectrics is known exactly.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "support/dielectric_scenes.h"
#include "support/expect_statistics.h"
#include "support/render.h"

namespace lab {
namespace {

// Many more bounces than a path needs to leave these scenes.
constexpr uint32_t unlimited = 1000;

// With this cap roulette ends only paths of throughput 0.
RenderSettings make_settings(uint32_t samples, uint32_t seed) {
    return {.samples = samples,
            .max_path_length = unlimited,
            .seed = seed,
            .survival_cap = 1,
            .estimator = chapter_estimator(chapter_named("dielectrics"))};
}

// Expects each channel of all pixels to have this mean; a larger relative bias would have been found.
void expect_radiance(const std::string& what, const FilmImage& film, const glm::dvec3& expected, double largest_relative_bias,
                     size_t comparisons) {
    for (int channel = 0; channel < 3; ++channel)
        expect_mean(what + ", " + channel_names[static_cast<size_t>(channel)], estimate_mean(pixel_means(film, channel)),
                    expected[channel], largest_relative_bias, comparisons);
}

// The mean of Fresnel's two reflectances. (Estimators that track polarisation would find slightly more light behind an oblique
// pane: the first interface polarises the light, and the second reflects less of that.)
double fresnel_reflectance(double cos_theta, double eta) {
    const double cos_theta_t = std::sqrt(1 - (1 - cos_theta * cos_theta) / (eta * eta));
    const double r_s = (cos_theta - eta * cos_theta_t) / (cos_theta + eta * cos_theta_t);
    const double r_p = (eta * cos_theta - cos_theta_t) / (eta * cos_theta + cos_theta_t);
    return 0.5 * (r_s * r_s + r_p * r_p);
}

// A pane between z = 0 and z = -thickness, seen from +Z at the given angle to its normal, and a black wall of emission 1 behind
// it or behind the camera.
enum class Lamp { behind_pane, behind_camera };
Scene make_pane(const Material& glass, float thickness, float degrees, Lamp lamp) {
    constexpr float size = 20;
    const bool is_behind = lamp == Lamp::behind_pane;
    const auto wall = [](float z, bool faces_up, uint32_t material) {
        const vec3 corner(-size, -size, z), x(2 * size, 0, 0), y(0, 2 * size, 0);
        return faces_up ? Quad{corner, x, y, material} : Quad{corner, y, x, material};
    };
    Scene scene = make_scene({diffuse_material(vec3(0), vec3(1)), glass},
                             {wall(is_behind ? -5.0f : 5.0f, is_behind, 0), wall(0, true, 1), wall(-thickness, false, 1)});
    scene.camera = {
        .position = {0, 0, 1}, .target = {std::tan(glm::radians(degrees)), 0, 0}, .up = {0, 1, 0}, .vertical_fov = 0.001f};
    return scene;
}

// Geometric series over the reflections between the two surfaces: with each, a path crosses the pane once and retains the
// fraction t of its light.
TEST(Dielectric, PaneTransmitsAndReflectsTheGeometricSeries) {
    constexpr float index = 1.5f, thickness = 0.5f;
    uint32_t seed = 1;
    for (const float degrees : {0.0f, 60.0f})
        for (const vec3& absorption : {vec3(0), vec3(0.3f, 0.7f, 1.5f)}) {
            const double cos_theta = std::cos(glm::radians(double{degrees}));
            const double cos_theta_t = std::sqrt(1 - (1 - cos_theta * cos_theta) / (index * index));
            const double r = fresnel_reflectance(cos_theta, index);
            const glm::dvec3 t = glm::exp(-glm::dvec3(absorption) * double{thickness} / cos_theta_t);
            const glm::dvec3 series = 1.0 / (1.0 - r * r * t * t);
            const std::string angle = std::to_string(static_cast<int>(degrees)) +
                                      (absorption == vec3(0) ? " degrees, clear, " : " degrees, absorbing, ");
            const Material glass = dielectric_material(index, absorption);
            // Without absorption these are (1 - R)/(1 + R) and 2R/(1 + R).
            expect_radiance(angle + "transmitted",
                            render(make_pane(glass, thickness, degrees, Lamp::behind_pane), make_settings(180, ++seed)),
                            (1 - r) * (1 - r) * t * series, 0.01, 24);
            expect_radiance(angle + "reflected",
                            render(make_pane(glass, thickness, degrees, Lamp::behind_camera), make_settings(360, ++seed)),
                            r + (1 - r) * (1 - r) * r * t * t * series, 0.03, 24);
        }
}

// Without reflection nothing is random, so Beer's law must hold up to rounding, which includes that rays start a little off the
// surface. Lengths are in world space, not in the space of the scaled mesh.
void expect_beers_law(float thickness, float degrees, float scale, Backend backend) {
    const glm::dvec3 absorption(0.2, 1, 2.5);
    Scene scene = make_pane(dielectric_material(1, vec3(absorption)), thickness, degrees, Lamp::behind_pane);
    set_transform(scene, mat4x3(scale, 0, 0, 0, scale, 0, 0, 0, scale, 0, 0, 0));
    RenderSettings settings = make_settings(2, 1);
    settings.roulette_start = unlimited;
    settings.max_path_length = 2;  // exactly enough: a bounce at each side of the pane
    settings.backend = backend;
    const FilmImage film = render(scene, settings);
    const double length = double{thickness} * scale / std::cos(glm::radians(double{degrees}));
    double worst = 0;
    for (int channel = 0; channel < 3; ++channel)
        for (const double mean : pixel_means(film, channel))
            worst = std::max(worst, std::abs(mean / std::exp(-absorption[channel] * length) - 1));
    std::printf("  length %.3f: largest relative error of the transmittance %.2g\n", length, worst);
    EXPECT_LT(worst, 5e-4);
}

TEST(Dielectric, AbsorbsByBeersLaw) {
    expect_beers_law(0.1f, 0, 1, compute_backend);
    expect_beers_law(1, 0, 1, compute_backend);
    expect_beers_law(1, 50, 1, compute_backend);
}

class DielectricOnEachBackend : public OnEachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, DielectricOnEachBackend, testing::ValuesIn(all_backends), backend_name);

TEST_P(DielectricOnEachBackend, AbsorbsByBeersLaw) { expect_beers_law(0.5f, 30, 3, GetParam()); }

// A body without absorption re-emits all light it receives, and outside it radiance is as if it were not there: under a uniform
// sky it is invisible. A factor η² that is missing, or not undone where the path leaves, would show.
TEST(Dielectric, BodyUnderAUniformSkyIsInvisible) {
    for (const float index : {1.5f, 2.4f, 0.75f}) {
        Scene scene = make_sphere(dielectric_material(index), Facing::outwards);
        scene.background = {1, 2, 3};
        scene.camera.vertical_fov = 40;
        RenderSettings settings = make_settings(40, 1);
        settings.roulette_start = unlimited;
        expect_radiance("sphere of index " + std::to_string(index), render(scene, settings), glm::dvec3(scene.background), 1e-4,
                        9);
    }
}

// Directions on different sides of the triangle and its interpolated normal carry no light, so a smooth body loses some light at
// its silhouette and never gains any.
TEST(Dielectric, SmoothBodyLosesLittle) {
    for (const float index : {1.5f, 0.75f}) {
        Scene scene = make_sphere(dielectric_material(index), Facing::outwards);
        scene.normals = scene.positions;
        scene.background = vec3(1);
        scene.camera.vertical_fov = 40;
        const std::vector<double> means = pixel_means(render(scene, make_settings(100, 1)), 0);
        const double loss = 1 - estimate_mean(means).mean;
        std::printf("  sphere of 80 triangles, index %.2f: %.2f %% of the image is lost\n", index, 100 * loss);
        EXPECT_LT(*std::max_element(means.begin(), means.end()), 1 + 1e-5);
        EXPECT_LT(loss, 0.05);
    }
}

// Inside glass of index n everything is n² times as bright, in all directions from which light can enter.
TEST(Dielectric, RadianceWithinIsTheIndexSquaredTimesThatOutside) {
    constexpr float index = 1.5f;
    Scene scene = make_scene({dielectric_material(index)}, box_sides(vec3(-1), vec3(1), 0, Facing::outwards));
    scene.background = vec3(1, 2, 3);
    scene.camera = {.position = {0.1f, 0.2f, 0}, .target = {0, 0, -1}, .up = {0, 1, 0}, .vertical_fov = 40};
    expect_radiance("towards a side", render(scene, make_settings(20, 1)),
                    glm::dvec3(index * index) * glm::dvec3(scene.background), 1e-5, 3);
    // Towards a corner: total reflection at all sides, forever.
    scene.camera.target = scene.camera.position + vec3(-1, 1, -1);
    scene.camera.vertical_fov = 10;
    const FilmImage film = render(scene, make_settings(1, 1));
    for (const double mean : pixel_means(film, 0)) ASSERT_EQ(mean, 0);
}

// Seen from outside, an emitter in glass is n² times darker; seen from inside, one outside is n² times brighter, except for what
// the surface reflects. A black emitter absorbs what returns to it, the dark sky what leaves.
TEST(Dielectric, EmissionPassesTheSurfaceOnce) {
    const double index = 1.5, r = fresnel_reflectance(1, index);
    for (const float lamp_z : {-0.5f, -2.0f}) {
        std::vector<Quad> quads{{{-0.9f, -0.9f, lamp_z}, {1.8f, 0, 0}, {0, 1.8f, 0}, 0}};
        for (const Quad& side : box_sides(vec3(-1), vec3(1), 1, Facing::outwards)) quads.push_back(side);
        Scene scene = make_scene({diffuse_material(vec3(0), vec3(1)), dielectric_material(1.5f)}, quads);
        const bool is_lamp_inside = lamp_z > -1;
        scene.camera = {.position = {0.1f, 0.2f, is_lamp_inside ? 3.0f : 0.0f},
                        .target = {0.1f, 0.2f, -1},
                        .up = {0, 1, 0},
                        .vertical_fov = 1};
        expect_radiance(is_lamp_inside ? "lamp within" : "camera within", render(scene, make_settings(100, 1)),
                        glm::dvec3(is_lamp_inside ? (1 - r) / (index * index) : index * index / (1 + r)), 0.01, 6);
    }
}

// The camera ray is absorbed as well: over a length of 1, plus 2 per reflection.
TEST(Dielectric, AbsorbsWhatTheCameraSeesWithin) {
    const glm::dvec3 absorption(0, 0.5, 1), once = glm::exp(-absorption), twice = once * once;
    Scene scene = make_scene({dielectric_material(1.5f, vec3(absorption))}, box_sides(vec3(-1), vec3(1), 0, Facing::outwards));
    scene.background = vec3(1);
    scene.camera = {.position = {0.1f, 0.2f, 0}, .target = {0.1f, 0.2f, -1}, .up = {0, 1, 0}, .vertical_fov = 1};
    const double r = fresnel_reflectance(1, 1.5);
    expect_radiance("towards a side", render(scene, make_settings(100, 1)), 2.25 * (1 - r) * once / (1.0 - r * twice), 0.01, 3);
}

}  // namespace
}  // namespace lab
