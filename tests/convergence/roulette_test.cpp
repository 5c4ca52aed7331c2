// Chapter 5: Russian roulette in a furnace, where mean, variance and cost are known for every survival probability.
#include <cmath>

#include "support/expect_statistics.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

constexpr uint32_t endless = 100'000;

// Inside a box whose walls emit 1 and reflect `albedo`; bounces find the emission.
Batches render_furnace(const std::string& chapter, const vec3& albedo, RenderSettings settings, uint32_t count) {
    settings.strategy = Strategy::bounces;
    settings.estimator = chapter_estimator(chapter);
    return render_batches(closed_box(diffuse_material(albedo, vec3(1))), settings, count);
}

// Second moment of a channel: the mean squared sample, one number per batch of one sample.
std::vector<double> square_means(const Batches& batches) {
    std::vector<double> means;
    for (const auto& image : batches.images) {
        double sum = 0;
        for (const auto& radiance : image) sum += radiance.g * radiance.g;
        means.push_back(sum / static_cast<double>(image.size()));
    }
    return means;
}

std::vector<Difference> relative_difference(const std::vector<double>& numbers, double expected) {
    return {difference_from(numbers, expected).relative_to(expected)};
}

class Roulette : public OnEachChapter {};
INSTANTIATE_TEST_SUITE_P(Chapters, Roulette, testing::ValuesIn(chapters_that(has_roulette)), own_estimator_name);

// With survival probability p at every bounce a path sees X = 1 + (a/p) X' with probability p, else 1. So E[X] = m = 1/(1-a),
// E[X²] = (1 + 2am)/(1 - a²/p), and it traces 1/(1-p) rays.
TEST_P(Roulette, HasTheKnownMeanVarianceAndCost) {
    const struct {
        float albedo, cap;
        bool is_fourth_moment_finite;  // a⁴/p³ < 1: otherwise the estimate of the variance is unreliable
    } cases[] = {
        {0.5f, 0.45f, true},  {0.5f, 0.5f, true},  {0.5f, 0.95f, true}, {0.8f, 0.7f, false},
        {0.8f, 0.75f, false}, {0.8f, 0.78f, true}, {0.8f, 0.95f, true},
    };
    uint32_t seed = chapter_seed(GetParam());
    for (const auto& [albedo, cap, is_fourth_moment_finite] : cases) {
        RenderSettings settings{.samples = 1, .max_path_length = endless, .seed = ++seed};
        settings.survival_cap = cap;
        const Batches batches = render_furnace(GetParam(), vec3(albedo), settings, 256);
        // The compensated throughput is a after the first bounce, and 1 or more after a survival.
        const double a = albedo, p = std::min(albedo, cap), m = 1 / (1 - a);
        char name[100];
        std::snprintf(name, sizeof(name), "albedo %.2f, cap %.2f: ", a, double{cap});
        expect_no_difference(std::string(name) + "mean", relative_difference(batches.means(1), m), 0.02, 20);
        expect_no_difference(std::string(name) + "rays", relative_difference(batches.rays, 1 / (1 - p)), 0.01, 20);
        if (is_fourth_moment_finite)
            expect_no_difference(std::string(name) + "square",
                                 relative_difference(square_means(batches), (1 + 2 * a * m) / (1 - a * a / p)), 0.15, 20);
    }
}

TEST_P(Roulette, SurvivalIsTheLargestComponentOfTheThroughput) {
    const vec3 albedo(0.2f, 0.4f, 0.6f);
    RenderSettings settings{.samples = 16, .max_path_length = endless};
    const Batches batches = render_furnace(GetParam(), albedo, settings, 64);
    std::vector<Difference> means;
    for (int channel = 0; channel < 3; ++channel)
        means.push_back(relative_difference(batches.means(channel), 1 / (1 - double{albedo[channel]})).front());
    expect_no_difference("means", means, 0.01, 2);
    expect_no_difference("rays", relative_difference(batches.rays, 1 / (1 - 0.6)), 0.01, 2);
}

class SplitRoulette : public Roulette {};
INSTANTIATE_TEST_SUITE_P(Chapters, SplitRoulette, testing::ValuesIn(chapters_that(has_roulette, splits_paths)), chapter_name);

TEST_P(SplitRoulette, IgnoresTheSplitting) {
    // Each of s branches traces p/(1-p) rays, and the variance of one is divided by s: if the factor 1/s were part of the
    // throughput, more of them would end.
    const double a = 0.5, m = 2, variance = (1 + 2 * a * m) / (1 - a) - m * m;
    for (const uint32_t s : {1u, 4u, 7u}) {
        RenderSettings settings{
            .samples = 1, .max_path_length = endless, .seed = chapter_seed(GetParam()) + 20 + s, .splitting_factor = s};
        const Batches batches = render_furnace(GetParam(), vec3(0.5f), settings, 96);
        const std::string name = "s = " + std::to_string(s) + ": ";
        expect_no_difference(name + "mean", relative_difference(batches.means(1), m), 0.02, 9);
        expect_no_difference(name + "rays", relative_difference(batches.rays, 1 + s * a / (1 - a)), 0.02, 9);
        expect_no_difference(name + "square", relative_difference(square_means(batches), m * m + variance / s), 0.03, 9);
    }
}

TEST_P(Roulette, BeginsAtItsStart) {
    // Before it no path ends; at bounce 3 the survivors' throughput a³ is compensated at once.
    const double a = 0.5;
    RenderSettings settings{.samples = 16, .max_path_length = endless, .roulette_start = 3};
    const Batches batches = render_furnace(GetParam(), vec3(0.5f), settings, 64);
    expect_no_difference("mean", relative_difference(batches.means(1), 2), 0.01, 2);
    expect_no_difference("rays", relative_difference(batches.rays, 3 + a * a * a / (1 - a)), 0.01, 2);
}

TEST_P(Roulette, SurvivorsCarryTheSurvivalWeight) {
    // With survival weight a² and no cap, two bounces are certain. From then on a path of weight a² survives with probability a,
    // and so sees 1 + a + a² X' with E[X'] = 1/(1-a) and Var X' = a/(1-a)².
    const double a = 0.5, m = 1 / (1 - a), variance = std::pow(a, 4) * a * m * m;
    RenderSettings settings{.samples = 1, .max_path_length = endless, .seed = chapter_seed(GetParam()) + 40};
    settings.survival_cap = 1;
    settings.survival_weight = 0.25f;
    const Batches batches = render_furnace(GetParam(), vec3(0.5f), settings, 96);
    expect_no_difference("mean", relative_difference(batches.means(1), m), 0.01, 3);
    expect_no_difference("rays", relative_difference(batches.rays, 2 + m), 0.01, 3);
    expect_no_difference("square", relative_difference(square_means(batches), m * m + variance), 0.01, 3);
}

}  // namespace
}  // namespace lab
