// Free flights in homogeneous media: the exponential distribution, word by word.
#include <cmath>
#include <cstdio>

#include "support/chapters.h"
#include "support/gpu_test.h"
#include "support/pcg2d.h"

namespace lab {
namespace {

struct Input {
    RandomState seed;
    float extinction;
};

std::vector<float> sample_flights(const std::vector<Input>& inputs) {
    const auto folder = chapter_estimator(chapter_named("media")).file.parent_path();
    return run_shader<float>({"flights.comp", {}, {{"flights.glsl", folder / "flights.glsl"}}}, inputs);
}

// With this word, the second one does not matter.
RandomState state_with(uint64_t word) { return state_before(word << 32 | 0x12345678); }

TEST(FreeFlights, AreTheLogarithmOfTheirRandomWord) {
    std::vector<Input> inputs;
    std::vector<double> expected;
    for (uint64_t word = 0; word < 1ull << 32; word += 1 + word / 40)
        for (const float extinction : {1e-8f, 1.0f, 30.0f}) {
            inputs.push_back({state_with(word), extinction});
            expected.push_back(-std::log1p(-(static_cast<double>(word) + 0.5) * 0x1p-32) / double{extinction});
        }
    for (const uint64_t distance_to_last : {0, 1, 2, 10, 1000}) {
        const uint64_t word = 0xffffffff - distance_to_last;
        inputs.push_back({state_with(word), 1});
        expected.push_back(-std::log((static_cast<double>(distance_to_last) + 0.5) * 0x1p-32));
    }
    const auto flights = sample_flights(inputs);
    double worst = 0;
    for (size_t i = 0; i < inputs.size(); ++i) worst = std::max(worst, std::abs(double{flights[i]} / expected[i] - 1));
    std::printf("  largest relative error of %zu flights %.2g\n", inputs.size(), worst);
    EXPECT_LT(worst, 5e-4);  // Vulkan allows log() an error of 2^-21
}

// In a thin medium few of the 2^32 words let a flight end within one unit of length: their part is the probability.
TEST(FreeFlights, EndInThinMediaAsOftenAsTheyShould) {
    for (const float extinction : {1e-3f, 1e-4f, 1e-5f, 1e-6f, 1e-7f, 1e-8f}) {
        const double expected = -std::expm1(-double{extinction}) * 0x1p32;
        const auto middle = static_cast<int64_t>(expected);
        std::vector<Input> inputs;
        int64_t first = std::max(middle - 2000, int64_t{0});
        for (int64_t word = first; word < middle + 2000; ++word)
            inputs.push_back({state_with(static_cast<uint64_t>(word)), extinction});
        const auto flights = sample_flights(inputs);
        const auto collisions = first + std::ranges::count_if(flights, [](float flight) { return flight < 1; });
        EXPECT_TRUE(first == 0 || flights.front() < 1);
        EXPECT_GE(flights.back(), 1);
        const double bias = static_cast<double>(collisions) / expected - 1;
        std::printf("  extinction %g: too many collisions by %.3g\n", extinction, bias);
        EXPECT_LE(std::abs(bias), 1e-6 + 0.51 / expected);
    }
}

}  // namespace
}  // namespace lab
