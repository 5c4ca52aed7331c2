// Chapter 17: the derivative of the picture with respect to an albedo equals closed forms, and differences of pictures.
#include <cmath>
#include <optional>

#include "support/agreement.h"
#include "support/expect_statistics.h"
#include "support/scenes.h"

namespace lab {
namespace {

constexpr uint32_t derivative_batches = 16;

// Renders the derivative with respect to the logarithm of this material's albedo, or the picture.
RenderSettings derivative_settings(std::optional<uint32_t> material) {
    RenderSettings settings{.width = 48,
                            .height = 48,
                            .samples = 64,
                            .max_path_length = 6,
                            .roulette_start = 3,
                            .survival_weight = 0.5f,
                            .estimator = chapter_estimator(chapter_named("derivatives")),
                            .backend = fastest_backend()};
    if (material) settings.estimator.defines.push_back("DERIVATIVE " + std::to_string(*material) + "u");
    return settings;
}

void add(Batches& sum, double factor, const Batches& summand) {
    for (size_t i = 0; i < sum.images.size(); ++i)
        for (size_t pixel = 0; pixel < sum.images[i].size(); ++pixel) sum.images[i][pixel] += factor * summand.images[i][pixel];
}

// The derivative that pictures at a step to each side tell.
Batches central_difference(Batches after, const Batches& before, double step) {
    add(after, -1, before);
    for (auto& image : after.images)
        for (glm::dvec3& pixel : image) pixel /= 2 * step;
    return after;
}

// In a closed surface of albedo a and emission 1 the light of k bounces is a^k, and its derivative k a^k.
TEST(Derivatives, OfAFurnaceAreTheSeries) {
    const vec3 albedo(0.2f, 0.5f, 0.8f);
    RenderSettings settings = derivative_settings(0);
    settings.strategy = Strategy::bounces;
    settings.estimator.max_threads_per_pixel = 1;  // so that one path follows another
    settings.max_path_length = 8;
    settings.samples = 400;
    const FilmImage film = render(closed_box(diffuse_material(albedo, vec3(1))), settings);
    for (int channel = 0; channel < 3; ++channel) {
        double expected = 0;
        for (int k = 1; k <= 8; ++k) expected += k * std::pow(double{albedo[channel]}, k);
        expect_mean(channel_names[static_cast<size_t>(channel)], estimate_mean(pixel_means(film, channel)), expected, 0.003, 3);
    }
}

// Of light that it alone scatters, once, it is that light, to the bit: x - 0 and 1 x are exact.
TEST(Derivatives, OfDirectLightAreThatLight) {
    Scene scene = load_shipped_scene("cornell_box.json");
    for (uint32_t& material : scene.triangle_materials)
        if (scene.materials[material].emission == vec3(0)) material = 0;
    const auto direct_light = [&](std::optional<uint32_t> material) {
        RenderSettings settings = derivative_settings(material);
        settings.only_path_length = 1;
        settings.max_path_length = 1;
        return render(scene, settings).mean().pixels;
    };
    EXPECT_EQ(direct_light(0), direct_light({}));
}

// A black material has no derivative with respect to the logarithm of its albedo, and no invalid samples.
TEST(Derivatives, OfABlackMaterialAreZero) {
    Scene scene = load_shipped_scene("cornell_box.json");
    scene.materials[1].diffuse_albedo = vec3(0);
    for (const float value : render(scene, derivative_settings(1)).mean().pixels) ASSERT_EQ(value, 0);
}

// The sum over all materials: the number of scatterings, weighted by the light. It is Σ k L_k of the light of k bounces.
TEST(Derivatives, AddUpToTheNumberOfScatterings) {
    const Scene scene = load_shipped_scene("cornell_box.json");
    std::vector<std::vector<double>> sums(3, std::vector<double>(derivative_batches, 0));
    for (uint32_t material = 0; material < scene.materials.size(); ++material) {
        const Batches batches = render_batches(scene, derivative_settings(material), derivative_batches);
        for (int channel = 0; channel < 3; ++channel) {
            const std::vector<double> means = batches.means(channel);
            for (size_t i = 0; i < means.size(); ++i) sums[static_cast<size_t>(channel)][i] += means[i];
        }
    }
    std::vector<double> expected(3, 0);
    for (int k = 1; k <= 6; ++k) {
        RenderSettings settings = derivative_settings({});
        settings.only_path_length = k;
        settings.samples = 1024;
        const std::array<double, 3> mean = render(scene, settings).mean_radiance();
        for (size_t channel = 0; channel < 3; ++channel) expected[channel] += k * mean[channel];
    }
    for (size_t channel = 0; channel < 3; ++channel)
        expect_mean(channel_names[channel], estimate_mean(sums[channel]), expected[channel], 0.01, 3);
}

// Equal to the difference of two pictures whose albedos are a little larger and smaller.
struct DerivativeCase {
    std::string scene;
    uint32_t samples;
    Run run;
};
class DerivativesOf : public testing::TestWithParam<DerivativeCase> {};
INSTANTIATE_TEST_SUITE_P(Scenes, DerivativesOf,
                         testing::Values(DerivativeCase{"cornell_box", 64, Run::always},
                                         DerivativeCase{"smoke", 64, Run::with_all}, DerivativeCase{"studio", 512, Run::with_all},
                                         DerivativeCase{"glass", 512, Run::with_all},
                                         DerivativeCase{"glossy", 1024, Run::with_all}),
                         [](const auto& info) { return instance_name(info.param.scene, info.param.run); });

TEST_P(DerivativesOf, AreDifferencesOfPictures) {
    const Scene scene = load_shipped_scene(GetParam().scene + ".json");
    const auto settings_of = [](std::optional<uint32_t> material) {
        RenderSettings settings = derivative_settings(material);
        settings.samples = GetParam().samples;
        return settings;
    };
    const Batches derivative = render_batches(scene, settings_of(0), derivative_batches);
    // The third derivative leaves an error of h² k² / 6 of the light that is scattered k times.
    constexpr float h = 0.03f;
    const auto render_with = [&](float factor) {
        Scene changed = scene;
        changed.materials[0].diffuse_albedo *= factor;
        changed.materials[0].specular_albedo *= factor;
        return render_batches(changed, settings_of({}), derivative_batches);
    };
    const Batches difference = central_difference(render_with(std::exp(h)), render_with(std::exp(-h)), h);
    expect_agreement(GetParam().scene, derivative, difference, {0.02, 0.5});
}

// ---------------------------------------------------------------------------------------------- lamps that move
constexpr float step_of_lamps = 0.02f;  // to each side: the third derivative adds some 10^-4

struct LitCorner {
    vec3 moved{0};           // the lamp
    bool has_screen = true;  // between lamp and floor, out of the camera's sight
};

// A floor and two walls of three colours, lit from above.
Scene lit_corner(const LitCorner& corner) {
    const vec3 lamp = vec3(-0.2f, 2, -0.2f) + corner.moved;
    std::vector<Quad> quads{{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0},
                            {{-1, 0, -1}, {2, 0, 0}, {0, 1, 0}, 1},
                            {{-1, 0, 1}, {0, 0, -2}, {0, 1, 0}, 2},
                            {lamp, {0.5f, 0, 0}, {0, 0, 0.5f}, 3}};
    if (corner.has_screen) quads.push_back({{-0.3f, 1.4f, -0.3f}, {0.5f, 0, 0}, {0, 0, 0.5f}, 0});
    Scene scene = make_scene({diffuse_material(vec3(0.7f)), diffuse_material({0.3f, 0.6f, 0.2f}),
                              diffuse_material({0.6f, 0.1f, 0.1f}), diffuse_material(vec3(0), vec3(10))},
                             quads);
    scene.camera = {.position = {0.4f, 1.2f, 1.2f}, .target = {-0.3f, 0.2f, -0.3f}, .up = {0, 1, 0}, .vertical_fov = 60};
    return scene;
}

class DerivativesByLamps : public testing::TestWithParam<int> {
  protected:
    // The light that the floor and the walls scatter once, or with `differentiated` its derivative.
    static Batches direct_light(const LitCorner& corner, bool differentiated = false) {
        RenderSettings settings = derivative_settings({});
        settings.only_path_length = settings.max_path_length = 1;
        settings.strategy = Strategy::light;
        settings.samples = 256;
        if (differentiated) settings.estimator.defines.push_back("MOVE_LAMPS " + std::to_string(GetParam() + 1));
        return render_batches(lit_corner(corner), settings, derivative_batches);
    }

    // Of pictures whose lamp is a little farther along the axis, and less far. Their random numbers are the same.
    static Batches difference(bool has_screen) {
        vec3 step(0);
        step[GetParam()] = step_of_lamps;
        return central_difference(direct_light({step, has_screen}), direct_light({-step, has_screen}), step_of_lamps);
    }

    // The pixels where some samples are hidden by the screen and some are not, wherever the lamp is in these differences.
    static std::vector<bool> find_penumbrae() {
        std::vector<bool> found;
        for (const float side : {-1.0f, 1.0f}) {
            vec3 moved(0);
            moved[GetParam()] = 1.5f * side * step_of_lamps;
            const Batches lit = direct_light({moved}), unhidden = direct_light({moved, false});
            found.resize(lit.images[0].size());
            for (size_t pixel = 0; pixel < found.size(); ++pixel) {
                size_t all = 0, none = 0;
                for (size_t i = 0; i < lit.images.size(); ++i) {
                    all += lit.images[i][pixel] == unhidden.images[i][pixel];
                    none += lit.images[i][pixel] == glm::dvec3(0);
                }
                found[pixel] = found[pixel] || (all < lit.images.size() && none < lit.images.size());
            }
        }
        return found;
    }

    // Errors are found relative to a mean, and that of a derivative may be 0: adds twice the light, which is larger than both.
    static void expect_same(const char* what, Batches derivative, Batches differences, const Batches& light) {
        add(derivative, 2, light);
        add(differences, 2, light);
        expect_agreement(what, derivative, differences, {0.005, 0.1});
    }
};
INSTANTIATE_TEST_SUITE_P(Axes, DerivativesByLamps, testing::Range(0, 3),
                         [](const auto& info) { return std::string(1, "XYZ"[info.param]); });

TEST_P(DerivativesByLamps, AreDifferencesWhereNothingCastsAShadow) {
    expect_same("no screen", direct_light({.has_screen = false}, true), difference(false), direct_light({.has_screen = false}));
}

// A penumbra is where some light samples are hidden and some are not. In it the edge of the shadow moves.
TEST_P(DerivativesByLamps, AreWrongInPenumbraeAlone_all) {
    Batches derivative = direct_light({}, true), differences = difference(true);
    const std::vector<bool> is_penumbra = find_penumbrae();
    const size_t half = derivative.images.size() / 2;
    double inside = 0, outside = 0, all = 0;
    for (size_t pixel = 0; pixel < is_penumbra.size(); ++pixel) {
        glm::dvec3 error[2]{}, change[2]{};  // of independent halves, whose product has no noise on average
        for (size_t i = 0; i < derivative.images.size(); ++i) {
            error[i / half] += derivative.images[i][pixel] - differences.images[i][pixel];
            change[i / half] += differences.images[i][pixel];
            if (is_penumbra[pixel]) derivative.images[i][pixel] = differences.images[i][pixel] = glm::dvec3(0);
        }
        (is_penumbra[pixel] ? inside : outside) += glm::dot(error[0], error[1]);
        all += glm::dot(change[0], change[1]);
    }
    EXPECT_GE(inside, 0.95 * (inside + outside)) << "nearly all of the squared error lies in the penumbrae";
    EXPECT_GE(inside, 0.05 * all) << "and it is not small";
    expect_same("outside of the penumbrae", derivative, differences, direct_light({}));
}

}  // namespace
}  // namespace lab
