// All chapters have the same expected image on scenes without dielectrics. Chapters 6, 7 and 10 follow the same paths as another
// one here, as RepeatedChapter shows.
#include <algorithm>
#include <array>

#include "support/agreement.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

struct Subject {
    std::string name;
    Estimator estimator;
    uint32_t splitting_factor;
    uint32_t roulette_start = 1;
    uint32_t samples_divisor = 1;  // for samples of so many paths that fewer give the same error
};

// Two estimators to be compared. No image belongs to two pairs, so that the pairs' p-values are independent. The splitting
// factors vary with the path length.
using Pair = std::array<Subject, 2>;
Subject subject(const std::string& name, uint32_t splitting_factor = 1) {
    return {name + (splitting_factor > 1 ? ", s = " + std::to_string(splitting_factor) : ""),
            chapter_estimator(chapter_named(name)), splitting_factor};
}
const Pair bounces{subject("uniform_sampling"), subject("cosine_sampling")};
std::vector<Pair> light_sampling_pairs(uint32_t length) {
    const auto at_every_hit = [](const std::string& name, uint32_t s, uint32_t roulette_start) {
        return Subject{name + " at every hit, s = " + std::to_string(s), every_hit_estimator(), s, roulette_start, 2};
    };
    const uint32_t s = length == 1 ? 1 : length == 2 ? 5 : 3;
    std::vector<Pair> pairs;
    // At length 1 there is only one hit to split at.
    if (length > 1)
        pairs.push_back({at_every_hit("splitting", length == 2 ? 3 : 2, no_roulette),
                         at_every_hit("russian_roulette", length == 2 ? 2 : 3, 1)});
    pairs.push_back({subject("next_event_estimation"), subject("splitting", s)});
    pairs.push_back({subject("russian_roulette", 6 - s), subject("light_probes")});
    Subject by_light_samples = subject("light_probes");
    by_light_samples.name += " by light samples";
    by_light_samples.estimator.defines.emplace_back("STRATEGY STRATEGY_LIGHT");
    pairs.push_back({by_light_samples, subject("low_discrepancy_points")});
    return pairs;
}

constexpr uint32_t size = 48, batch_count = 32;

struct AgreementCase {
    std::string scene;
    uint32_t samples;                  // per batch
    uint32_t bounce_samples;           // per batch of chapters 1 and 2, which find lights by bounces only
    AgreementLimits of_bounces;        // for comparisons with chapters 1 or 2
    AgreementLimits of_light_samples;  // for all others
};

// The lower part of the scene, where no light is visible: it would only add noise. Small suns are dimmed, since bounces hit them
// so rarely that errors elsewhere would go unnoticed.
Scene load_test_scene(const std::string& name) {
    Scene scene = load_shipped_scene(name + ".json");
    scene.camera.target.y = 0.4f;
    scene.camera.vertical_fov = 16;
    if (scene.light_probe)
        for (float& number : scene.light_probe->pixels) number = std::min(number, 2.0f);
    return scene;
}

Batches render_subject(const Scene& scene, const Subject& subject, uint32_t length, uint32_t samples, uint32_t seed) {
    RenderSettings settings{.width = size,
                            .height = size,
                            .samples = samples / subject.samples_divisor,
                            .max_path_length = length,
                            .seed = seed,
                            .splitting_factor = subject.splitting_factor,
                            .roulette_start = subject.roulette_start};
    settings.estimator = subject.estimator;
    return render_batches(scene, settings, batch_count);
}

// Only with --all: ReferenceImage compares the chapters with an independent renderer, more accurately than they can be compared
// with each other.
class ChapterAgreement : public testing::TestWithParam<AgreementCase> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ChapterAgreement,
                         testing::Values(AgreementCase{"cornell_box", 6, 56, {0.06, 0.75}, {0.02, 0.18}},
                                         AgreementCase{"torus", 8, 64, {0.06, 0.9}, {0.02, 0.22}},
                                         AgreementCase{"heart_light", 8, 24, {0.025, 0.45}, {0.02, 0.4}},
                                         AgreementCase{"textured", 9, 6, {0.045, 0.45}, {0.045, 0.45}},
                                         AgreementCase{"glossy", 8, 64, {0.12, 3.5}, {0.05, 1.3}}),
                         [](const auto& instance) { return instance_name(instance.param.scene, Run::with_all); });

TEST_P(ChapterAgreement, HasTheSameImageAtEveryLength) {
    const auto& [name, samples, bounce_samples, of_bounces, of_light_samples] = GetParam();
    const Scene scene = load_test_scene(name);
    uint32_t seed = 1000;
    std::vector<double> p_values;
    for (const uint32_t length : {2u, 1u, 4u}) {
        const auto compare_pair = [&](const Pair& pair, uint32_t pair_samples, const AgreementLimits& limits) {
            const std::array images{render_subject(scene, pair[0], length, pair_samples, ++seed),
                                    render_subject(scene, pair[1], length, pair_samples, ++seed)};
            const auto more = expect_agreement("length " + std::to_string(length) + ": " + pair[0].name + " and " + pair[1].name,
                                               images[0], images[1], limits);
            p_values.insert(p_values.end(), more.begin(), more.end());
            return images;
        };
        const Batches oracle = length == 2 ? compare_pair(bounces, bounce_samples, of_bounces)[1]
                                           : render_subject(scene, bounces[1], length, bounce_samples, ++seed);
        for (const Pair& pair : light_sampling_pairs(length)) {
            const auto images = compare_pair(pair, samples, of_light_samples);
            for (size_t i = 0; i < pair.size(); ++i)
                expect_agreement("length " + std::to_string(length) + ": " + pair[i].name + " and cosine_sampling", images[i],
                                 oracle, of_bounces);
        }
    }
    expect_uniform("p-values of the tiles", p_values, 0.3);
}

// All variants that a chapter's shader can be compiled as, in a studio with rough metal.
TEST(ChapterChoices, ChangeTheNoiseAndNotTheImage_all) {
    Scene scene = load_shipped_scene("studio.json");
    make_metal(scene, 0.7f);
    uint32_t seed = 2000;
    for (const std::string& chapter : all_chapters)
        for (const ChapterChoice& choice : load_chapter(chapter).choices) {
            if (!choice.shows.empty()) continue;
            std::vector<Batches> images;
            for (const auto& [name, value] : choice.values) {
                Subject subject{name, chapter_estimator(chapter), 1};
                subject.estimator.defines = {choice.define() + " " + value};
                images.push_back(render_subject(scene, subject, 4, 24, ++seed));
                if (images.size() > 1) expect_agreement(choice.name + " " + name, images.back(), images.front(), {0.015, 0.3});
            }
        }
}

}  // namespace
}  // namespace lab
