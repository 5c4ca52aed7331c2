// Russian roulette, random number by random number: how many of the 2^64 pairs of words let a path survive.
#include "support/bounce.h"
#include "support/render.h"

namespace lab {
namespace {

class RouletteOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Chapters, RouletteOf, testing::ValuesIn(chapters_that(has_roulette, is_pseudorandom)), chapter_name);

TEST_P(RouletteOf, WeightsPathsByTheProbabilityWithWhichTheySurvive) {
    for (const float probability : {0.5f, 0.001f, 1e-6f, 1e-9f}) {
        const auto count = static_cast<uint64_t>(probability * 0x1p64);
        std::vector<RandomState> states;
        // The direction takes one step of the generator.
        for (const uint64_t bits : {count - 1, count}) states.push_back(previous_state(state_before(bits)));
        const auto bounces = bounces_with_roulette(GetParam(), probability, states);
        EXPECT_EQ(bounces[0].ray_count, 2u) << probability << ": the last that survives";
        EXPECT_NEAR(bounces[0].weight * probability, 1, 1e-6);
        EXPECT_EQ(bounces[1].ray_count, 1u) << probability << ": the first that ends";
    }
}

}  // namespace
}  // namespace lab
