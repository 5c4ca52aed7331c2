// Media by closed forms or quadrature: absorption, the furnace, single scattering of a slab, all orders of scattering of a
// half-space, and the mean length of paths in a convex body.
#include <cmath>
#include <numbers>

#include "support/expect_statistics.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr float glass_index = 1.5f;

Material surface(bool is_glass) {
    Material material = diffuse_material(vec3(0));
    if (is_glass) material.refractive_index = glass_index;
    return material;
}
// The medium fills the scene's only instance, whose surface is none or glass.
Scene filled(Scene scene, const Medium& medium, bool is_glass = false) {
    fill(scene, medium, is_glass);
    return scene;
}
Scene in_fog(Scene scene, const Medium& medium) {
    scene.media = {medium};
    return scene;
}

Scene box(const vec3& low, const vec3& high, bool is_glass = false) {
    return make_scene({surface(is_glass)}, box_sides(low, high, 0, Facing::outwards));
}

// Sees (almost) a single direction.
Scene seen(Scene scene, const vec3& from, const vec3& to, float field_of_view = 0.01f) {
    scene.camera = {.position = from, .target = to, .up = {0, 1, 0.01f}, .vertical_fov = field_of_view};
    return scene;
}

RenderSettings media_settings(uint32_t samples, Strategy strategy = Strategy::both) {
    return {.width = 32,
            .height = 32,
            .samples = samples,
            .max_path_length = 100'000,
            .roulette_start = no_roulette,
            .strategy = strategy,
            .estimator = chapter_estimator(chapter_named("media")),
            .backend = fastest_backend()};
}

// The film's mean in one channel, from independent batches.
MeanEstimate mean_of(const Scene& scene, const RenderSettings& settings, int channel = 0) {
    return estimate_mean(render_batches(scene, settings, 32).means(channel));
}

// What a ray finds behind an absorbing slab is the fraction of flights that are longer: T = e^(-σd). Of glass, the slab reflects
// R at once; what goes in, 1 - R, passes it once or several times and loses 1 - R at its end: R + (1 - R)² T / (1 - R T).
TEST(Media, FreeFlightsAreDistributedExponentially_all) {
    constexpr double amplitude = (glass_index - 1) / (glass_index + 1), r = amplitude * amplitude;
    for (const bool is_glass : {false, true})
        for (const float depth : {0.1f, 1.0f, 3.0f}) {
            Scene scene = filled(box({-1, -1, -0.5f}, {1, 1, 0}, is_glass), homogeneous_medium(2 * depth, vec3(0)), is_glass);
            scene.background = vec3(1);
            const double t = std::exp(-depth);
            expect_mean("optical depth " + std::to_string(depth) + (is_glass ? ", glass" : ""),
                        mean_of(seen(scene, {0, 0, 3}, {0, 0, 0}), media_settings(64)),
                        is_glass ? r + (1 - r) * (1 - r) * t / (1 - r * t) : t, 0.01, 6);
        }
}

// Without absorption, a body of any shape that is as bright as its surroundings disappears. No sample may differ, since all
// weights are 1: behind open boundaries, behind glass and in fog.
TEST(Media, WithoutAbsorptionDisappearInTheFurnace) {
    for (const float extinction : {1e-6f, 0.5f, 20.0f})
        for (const float anisotropy : {-0.9f, 0.0f, 0.5f, 0.999f})
            for (const bool is_glass : {false, true}) {
                SCOPED_TRACE(std::to_string(extinction) + ", " + std::to_string(anisotropy) + (is_glass ? ", glass" : ""));
                Scene scene = filled(make_sphere(surface(is_glass), Facing::outwards),
                                     homogeneous_medium(extinction, vec3(1), anisotropy), is_glass);
                scene.background = vec3(1);
                const FilmImage film = render(scene, media_settings(4));
                for (const FilmPixel& pixel : film.pixels) ASSERT_NEAR(pixel.sum.r, 4, 1e-4);
            }
}

// The same in a room whose walls glow, where light samples and bounces share the light.
TEST(Media, InARoomThatGlowsAreAsBrightAsTheWalls_all) {
    Scene room = make_scene({diffuse_material(vec3(0), vec3(1))}, box_sides(vec3(-1), vec3(1), 0, Facing::inwards));
    room.camera = {.position = {0, 0, 0.5f}, .target = {0, 0, 0}};
    for (const float anisotropy : {-0.5f, 0.8f}) {
        const Scene scene = in_fog(room, homogeneous_medium(2, vec3(1), anisotropy));
        for (const Strategy strategy : {Strategy::both, Strategy::bounces})
            expect_mean(to_string(strategy) + ", g " + std::to_string(anisotropy),
                        mean_of(scene, media_settings(strategy == Strategy::both ? 16 : 1, strategy)), 1, 0.004, 4);
    }
}

double phase(double g, double cos_theta) {
    return (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g - 2 * g * cos_theta, 1.5));
}

// A lamp above a wide slab: the radiance of light that has been scattered once, seen from straight above. At the depth z the lamp
// shines through z / μ' of the medium: a p(cos θ) (1 - e^(-σd (1 + 1/μ'))) / (1 + 1/μ'), integrated over the lamp.
TEST(Media, ASlabScattersOnceAsItsPhaseFunctionSays_all) {
    constexpr double distance = 2e4, half_side = 14e3, depth = 1.5, albedo = 0.6, tilt = 0.7;
    for (const double g : {-0.5, 0.4}) {
        const dvec3 centre = distance * dvec3(std::sin(tilt), 0, std::cos(tilt));
        const dvec3 u = half_side * dvec3(std::cos(tilt), 0, -std::sin(tilt)), v(0, half_side, 0);
        Scene scene = make_scene({diffuse_material(vec3(0)), diffuse_material(vec3(0), vec3(10))}, [&] {
            auto quads = box_sides({-100, -100, -1.5f}, {100, 100, 0}, 0, Facing::outwards);
            quads.push_back({vec3(centre - u - v), vec3(2.0 * v), vec3(2.0 * u), 1});
            return quads;
        }());
        // Two instances: the slab's boundary is open, the lamp is a surface.
        Mesh slab = scene.meshes[0], lamp = scene.meshes[0];
        slab.triangle_count = 12;
        lamp.first_triangle = 12, lamp.triangle_count = 2;
        scene.meshes = {slab, lamp};
        scene.instance_meshes = {0, 1};
        scene.instances.push_back(scene.instances[0]);
        fill(scene, homogeneous_medium(1, vec3(static_cast<float>(albedo)), static_cast<float>(g)));
        double expected = 0;
        constexpr int n = 200;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const dvec3 to_light = centre + (2 * (i + 0.5) / n - 1) * u + (2 * (j + 0.5) / n - 1) * v;
                const dvec3 omega = glm::normalize(to_light);
                const double cos_light = glm::dot(omega, centre) / distance;
                const double solid_angle = 4 * half_side * half_side / n / n * cos_light / glm::dot(to_light, to_light);
                const double slant = 1 + 1 / omega.z;
                expected += 10 * albedo * phase(g, -omega.z) * solid_angle * (1 - std::exp(-depth * slant)) / slant;
            }
        // Few bounces find the lamp, fewest if light mostly goes on.
        for (const auto& [strategy, samples] : {std::pair(Strategy::both, 16), {Strategy::bounces, g < 0 ? 128 : 1000}}) {
            RenderSettings settings = media_settings(static_cast<uint32_t>(samples), strategy);
            settings.only_path_length = 1;
            settings.max_path_length = 1;
            expect_mean("g " + std::to_string(g) + ", " + to_string(strategy),
                        mean_of(seen(scene, {0, 0, 5}, {0, 0, 0}), settings), expected, 0.01, 4);
        }
    }
}

// A lamp beside the ray in fog: light that has been scattered once, by quadrature over the ray and the lamp. All ways to sample
// the distance find it, with light samples alone as well as together with bounces.
TEST(Media, ALampInFogGlowsAsTheIntegralOverTheRaySays) {
    constexpr double extinction = 0.5, albedo = 0.6, g = 0.4, side = 0.2, x = 0.3;
    Scene scene = make_scene({diffuse_material(vec3(0), vec3(10))}, {{{0.3f, -0.1f, -0.1f}, {0, 0, 0.2f}, {0, 0.2f, 0}, 0}});
    scene = in_fog(scene,
                   homogeneous_medium(static_cast<float>(extinction), vec3(static_cast<float>(albedo)), static_cast<float>(g)));
    scene.media[0].largest_density = 1, scene.media[0].low = vec3(-20), scene.media[0].high = vec3(20);
    double expected = 0;
    constexpr int steps = 4000, n = 24;
    constexpr double length = 20;
    for (int k = 0; k < steps; ++k)
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) {
                const double t = (k + 0.5) / steps * length;
                const dvec3 to_light(x, ((i + 0.5) / n - 0.5) * side, ((j + 0.5) / n - 0.5) * side - (2 - t));
                const double r = glm::length(to_light), cos_theta = -to_light.z / r;
                expected += length / steps * extinction * albedo * std::exp(-extinction * (t + r)) * 10 * phase(g, cos_theta) *
                            x / r * side * side / n / n / (r * r);
            }
    const std::string light_alone = "STRATEGY STRATEGY_LIGHT", angles = "DISTANCE_SAMPLING SAMPLES_ANGLES";
    for (const auto& [name, is_grid, samples, defines] :
         {std::tuple("flights", false, 32u, std::vector<std::string>{}),
          {"flights, light samples alone", false, 32u, {light_alone}},
          {"angles", false, 8u, {angles}},
          {"angles, light samples alone", false, 8u, {angles, light_alone}},
          {"a grid", true, 64u, {}},
          {"a grid and angles, which need the same everywhere", true, 64u, {angles}}}) {
        scene.densities.assign(is_grid ? 2 : 0, 1);
        scene.media[0].grid_size = is_grid ? uvec3(1, 1, 2) : uvec3(0);
        RenderSettings settings = media_settings(samples);
        settings.only_path_length = 1;
        settings.max_path_length = 1;
        settings.estimator.defines = defines;
        expect_mean(name, mean_of(seen(scene, {0, 0, 2}, {0, 0, 0}), settings), expected, 0.01, 4);
    }
}

// H(μ) = 1 / (√(1 - a) + a/2 ∫ μ' H(μ') / (μ + μ') dμ') by iteration (Chandrasekhar, "Radiative Transfer", 1950).
double chandrasekhar_h(double albedo, double mu) {
    constexpr int n = 2000;
    std::vector<double> h(n, 1);
    const auto evaluate = [&](double at) {
        double integral = 0;
        for (int i = 0; i < n; ++i) integral += (i + 0.5) / n * h[static_cast<size_t>(i)] / (at + (i + 0.5) / n) / n;
        return 1 / (std::sqrt(1 - albedo) + 0.5 * albedo * integral);
    };
    for (int iteration = 0; iteration < 40; ++iteration) {
        std::vector<double> next(n);
        for (int i = 0; i < n; ++i) next[static_cast<size_t>(i)] = evaluate((i + 0.5) / n);
        h = next;
    }
    return evaluate(mu);
}

// All orders of scattering: under a white sky a half-space that scatters evenly shows 1 - √(1 - a) H(μ). The half-space is a box
// of 25 mean free paths. In a larger one, light would enter deeper than the surface: rays start off a surface by its rounding
// errors.
void expect_half_space(double mu, uint32_t samples, double largest_relative_bias) {
    const vec3 albedo(0.2f, 0.5f, 0.9f);
    Scene scene = filled(box({-25, -25, -25}, {25, 25, 0}), homogeneous_medium(1, albedo));
    scene.background = vec3(1);
    const double sin_theta = std::sqrt(1 - mu * mu);
    RenderSettings settings = media_settings(samples);
    settings.width = settings.height = 64;
    settings.roulette_start = 1;
    const Batches batches = render_batches(seen(scene, 10.0f * vec3(dvec3(sin_theta, 0, mu)), vec3(0)), settings, 32);
    for (int channel = 0; channel < 3; ++channel) {
        const double a = albedo[channel];
        expect_mean("albedo " + std::to_string(a) + ", cosine " + std::to_string(mu), estimate_mean(batches.means(channel)),
                    1 - std::sqrt(1 - a) * chandrasekhar_h(a, mu), largest_relative_bias, 6);
    }
}

TEST(Media, AHalfSpaceReflectsAsChandrasekharSays) {
    expect_half_space(1, 20, 0.008);
    expect_half_space(0.2, 20, 0.005);
}
TEST(Media, AHalfSpaceReflectsAsChandrasekharSays_all) {
    expect_half_space(1, 2200, 0.001);
    expect_half_space(0.2, 360, 0.001);
}

// Rays that enter a convex body from everywhere stay in it for the length 4V/S on average, however it scatters (Blanco and
// Fournier, "An invariance property of diffusive random walks", 2003): 4/3 in the unit sphere, where all directions are alike, so
// that parallel rays will do. With the albedo 1 - ε the furnace shows 1 - ε n + ε²/2 n (n - 1) on average after n collisions: two
// values of ε give the mean of n, which is σ times the length.
TEST(Media, PathsInAConvexBodyAreAsLongAsItsVolumeOverItsSurfaceSays_all) {
    constexpr int rings = 64;
    TriangleMesh ball;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < 2 * rings; ++j) {
            const double theta = std::numbers::pi * i / rings, phi = std::numbers::pi * j / rings;
            ball.positions.emplace_back(std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi));
        }
    for (uint32_t i = 0; i < rings; ++i)
        for (uint32_t j = 0; j < 2 * rings; ++j) {
            const uint32_t a = i * 2 * rings + j, b = i * 2 * rings + (j + 1) % (2 * rings), below = 2 * rings;
            if (i > 0) ball.triangles.emplace_back(a, b + below, b);
            if (i + 1 < rings) ball.triangles.emplace_back(a, a + below, b + below);
        }
    constexpr double field = 2.1, epsilon = 0.004, hit_fraction = std::numbers::pi / (field * field);
    for (const float extinction : {0.3f, 4.0f})
        for (const float anisotropy : {-0.6f, 0.0f, 0.9f}) {
            Scene scene = lit_scene(ball);
            place(scene, mat4x3(1));
            scene.background = vec3(1);
            scene = filled(scene, homogeneous_medium(extinction, vec3(1, 1 - epsilon, 1 - 0.5 * epsilon), anisotropy));
            scene = seen(scene, {0, 0, 1000}, {0, 0, 0}, static_cast<float>(glm::degrees(2 * std::atan(field / 2000))));
            const Batches batches = render_batches(scene, media_settings(40), 32);
            std::vector<double> lengths;
            for (size_t i = 0; i < batches.images.size(); ++i) {
                const double whole = (1 - batches.means(1)[i]) / epsilon, half = (1 - batches.means(2)[i]) / (0.5 * epsilon);
                lengths.push_back((2 * half - whole) / hit_fraction / double{extinction});
            }
            expect_mean("mean length, σ " + std::to_string(extinction) + ", g " + std::to_string(anisotropy),
                        estimate_mean(lengths), 4.0 / 3, 0.01, 6);
        }
}

}  // namespace
}  // namespace lab
