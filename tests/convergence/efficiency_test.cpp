// What each chapter gains over the previous one: error times cost, on the same scene in one run. The cost is the number of rays,
// so the test does not depend on the machine's load.
#include <cmath>
#include <cstdio>

#include "rendering/options.h"
#include "statistics/error_metrics.h"
#include "support/expect_statistics.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

// Logarithms of error times rays at one sample per pixel, from independent renders.
struct Cost {
    std::vector<double> logarithms;
    double error, rays;
};

Cost measure(const Scene& scene, RenderSettings settings) {
    constexpr uint32_t renders = 16;
    settings.samples *= 2;  // in halves, to estimate the error
    const double paths = static_cast<double>(settings.width) * settings.height * settings.samples;
    Cost cost{.logarithms = {}, .error = 0, .rays = 0};
    SceneRenderer renderer(scene, settings);
    for (uint32_t i = 0; i < renders; ++i) {
        const Rendering rendering = renderer.render(settings);
        ++settings.seed;
        const double error = settings.samples * estimate_error(rendering.film)->rel_mse;
        const double rays = static_cast<double>(rendering.rays) / paths;
        cost.error += error / renders;
        cost.rays += rays / renders;
        cost.logarithms.push_back(std::log(error * rays));
    }
    return cost;
}

// Expects `technique` to need fewer rays than `before` for the same error (Welch's test of the logarithms).
void expect_gain(const std::string& what, const Cost& before, const Cost& technique) {
    const Difference gain = difference_of(technique.logarithms, before.logarithms);
    std::printf("  %s: error x %.3f, rays x %.2f, error times rays x %.3f, p = %.2g; finds a gain of x %.2f\n", what.c_str(),
                technique.error / before.error, technique.rays / before.rays, std::exp(gain.value), gain.p_value(),
                std::exp(-gain.smallest_detectable(significance, power)));
    EXPECT_TRUE(gain.value < 0 && gain.p_value() < significance) << what << " does not pay";
}

Cost measure_chapter(const std::string& scene_name, const std::string& name, uint32_t samples, uint32_t length,
                     uint32_t splitting = 1) {
    const Scene scene = load_shipped_scene(scene_name + ".json");
    RenderSettings settings{.width = 64, .height = 64, .samples = samples, .max_path_length = length};
    settings.splitting_factor = splitting;
    settings.roulette_start = 2;
    const std::string chapter = chapter_named(name);
    settings.seed = chapter_seed(chapter);
    settings.estimator = chapter_estimator(chapter);
    return measure(scene, settings);
}

// Multiple importance sampling restricted to one of its two strategies.
Cost measure_strategy(const std::string& scene_name, Strategy strategy, uint32_t samples, uint32_t length) {
    RenderSettings settings{.width = 64, .height = 64, .samples = samples, .max_path_length = length};
    settings.roulette_start = 2;
    settings.seed = 7100;
    settings.estimator = chapter_estimator(chapter_named("multiple_importance_sampling"));
    if (strategy == Strategy::light) settings.estimator.defines = {"STRATEGY STRATEGY_LIGHT"};
    if (strategy == Strategy::bounces) settings.strategy = Strategy::bounces;
    return measure(load_shipped_scene(scene_name + ".json"), settings);
}

TEST(Efficiency, CosineSamplingAndNextEventEstimationPay_all) {
    const Cost uniform = measure_chapter("cornell_box", "uniform_sampling", 24, 4),
               cosine = measure_chapter("cornell_box", "cosine_sampling", 24, 4);
    expect_gain("cosine sampling against uniform angles", uniform, cosine);
    expect_gain("next event estimation against cosine sampling", cosine,
                measure_chapter("cornell_box", "next_event_estimation", 4, 4));
}

// Splitting pays if what comes after the first hit is noisy, as with a light of thousands of triangles. In the Cornell box, edges
// and camera rays cancel the gain.
TEST(Efficiency, SplittingPaysForNoisyLight_all) {
    expect_gain("splitting in 4 against next event estimation", measure_chapter("heart_light", "next_event_estimation", 16, 4),
                measure_chapter("heart_light", "splitting", 4, 4, 4));
}

// Without a path length limit there is more to estimate, and it still pays.
TEST(Efficiency, RussianRoulettePaysForLongPaths_all) {
    expect_gain("Russian roulette against splitting", measure_chapter("cornell_box", "splitting", 8, 8, 2),
                measure_chapter("cornell_box", "russian_roulette", 8, 1000, 2));
}

// The blog's trees: two branches at every hit and five bounces.
TEST(Efficiency, RoulettePaysWhereEveryHitSplits_all) {
    RenderSettings settings{.width = 64, .height = 64, .samples = 8, .max_path_length = 5};
    settings.splitting_factor = 2;
    settings.estimator = every_hit_estimator();
    settings.roulette_start = no_roulette;
    const Scene scene = load_shipped_scene("cornell_box.json");
    const Cost without = measure(scene, settings);
    settings.roulette_start = 1;
    settings.seed += 100;
    expect_gain("roulette where every hit splits", without, measure(scene, settings));
}

// Near lights, light samples are noisy; on glossy surfaces they miss the lobe.
TEST(Efficiency, MultipleImportanceSamplingPays_all) {
    expect_gain("multiple importance sampling against dielectrics, heart", measure_chapter("heart_light", "dielectrics", 12, 4),
                measure_chapter("heart_light", "multiple_importance_sampling", 12, 4));
    const Cost both = measure_chapter("plates", "multiple_importance_sampling", 8, 2);
    expect_gain("both strategies against light samples", measure_strategy("plates", Strategy::light, 32, 2), both);
    expect_gain("both strategies against bounces", measure_strategy("plates", Strategy::bounces, 32, 2), both);
}

TEST(Efficiency, SamplingTheLightProbePays_all) {
    expect_gain("light probes against multiple importance sampling, small sun",
                measure_chapter("sunny", "multiple_importance_sampling", 8, 2), measure_chapter("sunny", "light_probes", 4, 2));
    expect_gain("light probes against multiple importance sampling, wide sun",
                measure_chapter("textured", "multiple_importance_sampling", 8, 2),
                measure_chapter("textured", "light_probes", 4, 2));
}

TEST(Efficiency, LowDiscrepancyPointsPay_all) {
    expect_gain("low-discrepancy points against light probes, Cornell box", measure_chapter("cornell_box", "light_probes", 16, 4),
                measure_chapter("cornell_box", "low_discrepancy_points", 16, 4));
    expect_gain("low-discrepancy points against light probes, wide sun", measure_chapter("textured", "light_probes", 8, 2),
                measure_chapter("textured", "low_discrepancy_points", 8, 2));
}

// A floor, a ball and a torus of metal in a studio. Light samples find the lamps either way; the lobes see the rest.
TEST(Efficiency, VisibleNormalsPay_all) {
    Scene scene = load_shipped_scene("studio.json");
    make_metal(scene, 0.2f);
    RenderSettings settings{.width = 64, .height = 64, .samples = 16, .max_path_length = 8, .seed = 11000};
    settings.estimator = chapter_estimator(chapter_named("microfacets"));
    const Cost visible = measure(scene, settings);
    settings.estimator.defines = {"FACET_SAMPLING SAMPLES_COSINES"};
    settings.seed += 100;
    expect_gain("visible normals against the cosine", measure(scene, settings), visible);
}

// Lamps of 1:1000 in 16 rooms. The camera looks at the floor of one: lamps that it sees would add the same noise to both.
TEST(Efficiency, TheLightTreePays_all) {
    Scene scene = load_shipped_scene("lamps.json");
    scene.camera.target = {6, 0, 10.6f};
    scene.camera.vertical_fov = 40;
    RenderSettings settings{.width = 48, .height = 48, .samples = 16, .max_path_length = 2, .seed = 14000};
    settings.estimator = chapter_estimator(chapter_named("many_lights"));
    settings.backend = fastest_backend();
    const Cost tree = measure(scene, settings);
    settings.estimator.defines = {"LIGHT_CHOICE CHOOSES_BY_POWER"};
    settings.seed += 100;
    expect_gain("the light tree against the power of lamps", measure(scene, settings), tree);
}

}  // namespace
}  // namespace lab
