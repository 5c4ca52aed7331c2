// shaders/engine/film.glsl: sums of millions of samples, and samples that are not finite.
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

#include "shaders/interface.h"
#include "support/gpu_test.h"
#include "support/pcg2d.h"

namespace lab {
namespace {

// Values as in film.comp.
enum Kind : uint32_t { uniform, constant, outliers, invalid };

// The sum of a stream of samples, each times its factor. Their bits span less than a double's 53, so sums are exact; for the
// constant it is a product.
template <typename Factor>
std::array<double, 3> exact_sum(Kind kind, uint32_t samples, Factor factor) {
    std::array<double, 3> sum{};
    RandomState state = start_state(kind, 0, {0, 0});
    for (uint32_t i = 0; i < samples; ++i) {
        state = next_state(state);
        const auto u = numbers_of_state(state);
        if (kind == invalid && i % 5 == 0) continue;
        const double outlier = kind == outliers && i % 1024 == 0 ? 4096 : 0;
        const std::array<double, 3> numbers{u[0] + outlier, u[1] + outlier, 1 - u[0] + outlier};
        for (size_t channel = 0; channel < 3; ++channel)
            sum[channel] += factor(i) * (kind == constant ? 0.1f : static_cast<float>(numbers[channel]));
    }
    return sum;
}

TEST(Film, AddsTenMillionSamplesWithoutLosingAny) {
    struct Input {
        uint32_t kind, sample_count;
    };
    struct Result {
        FilmPixel pixel;
        vec3 plain_sum;
    };
    constexpr uint32_t samples = 10'000'000;
    const std::vector<Input> inputs{{uniform, samples}, {constant, samples}, {outliers, samples}, {invalid, samples}};
    const auto results = run_shader<Result>({"film.comp"}, inputs);
    double worst_plain = 0, worst_of_all = 0;
    for (size_t i = 0; i < inputs.size(); ++i) {
        const auto& [pixel, plain_sum] = results[i];
        const auto kind = static_cast<Kind>(inputs[i].kind);
        const auto expected = exact_sum(kind, samples, [](uint32_t) { return 1.0; }),
                   differences = exact_sum(kind, samples, [](uint32_t index) { return index % 2 == 0 ? 1.0 : -1.0; });
        double worst = 0;
        for (int channel = 0; channel < 3; ++channel) {
            const double exact = expected[static_cast<size_t>(channel)];
            const double sum = double{pixel.sum[channel]} + double{pixel.compensation[channel]};
            worst = std::max(worst, std::abs(sum / exact - 1));
            // The scale of the error: for random samples it is about the root of their number.
            const double difference = differences[static_cast<size_t>(channel)];
            EXPECT_NEAR(pixel.difference[channel], difference, 1e-3 * std::sqrt(samples) + 1e-4 * std::abs(difference))
                << "stream " << i;
            if (kind != invalid) worst_plain = std::max(worst_plain, std::abs(plain_sum[channel] / exact - 1));
        }
        std::printf("  stream %u: relative error of the sum %.2g\n", inputs[i].kind, worst);
        EXPECT_LE(worst, 1e-6) << "stream " << i;
        worst_of_all = std::max(worst_of_all, worst);
        EXPECT_EQ(pixel.sample_count, samples);
        EXPECT_EQ(pixel.invalid_count, kind == invalid ? samples / 5 : 0);
    }
    record("relative_error_of_a_sum", "%.1e after 1e7 samples", worst_of_all);
    record("relative_error_of_a_plain_sum", "%.1e", worst_plain);
    EXPECT_GT(worst_plain, 1e-4) << "a plain sum is as good: these streams test nothing";
}

TEST(Film, KnowsInvalidNumbersByTheirBits) {
    using Limits = std::numeric_limits<float>;
    std::vector<uint32_t> bits{0x7fc00000u, 0xffc00000u, 0x7f800001u, 0xffffffffu, 0x7f800000u, 0xff800000u};
    const size_t invalid_count = bits.size();
    for (const float number : {0.0f, -0.0f, 1.0f, -1.0f, Limits::max(), Limits::lowest(), Limits::min(), 65504.0f})
        bits.push_back(std::bit_cast<uint32_t>(number));
    bits.push_back(1);  // the smallest denormal
    const auto results = run_shader<uint32_t>({"film.comp", {"INVALID_BITS"}}, bits);
    for (size_t i = 0; i < bits.size(); ++i) EXPECT_EQ(results[i], i < invalid_count) << std::hex << bits[i];
}

}  // namespace
}  // namespace lab
