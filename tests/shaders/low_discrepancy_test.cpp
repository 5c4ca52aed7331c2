// Low-discrepancy points: how evenly they fill the unit square, and that they are otherwise independent.
#include <cstdio>

#include "rendering/renderer.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/render.h"

namespace lab {
namespace {

constexpr uint32_t pairs = 6;

// Layout as in low_discrepancy.comp.
struct SampleId {
    uint32_t pixel, sample;
    uvec2 key;
};
struct Words {
    uvec2 pair[pairs];
};

std::vector<Words> words_of(const std::vector<SampleId>& samples) {
    const Estimator estimator = chapter_estimator(chapter_named("low_discrepancy_points"));
    TestShader shader{.name = "low_discrepancy.comp", .defines = estimator.defines, .named_includes = named_includes(estimator)};
    shader.defines.push_back("PAIRS " + std::to_string(pairs));
    return run_shader<Words>(shader, samples);
}

// Points of pixels 0, 1, …, for samples first, …, end - 1 of each.
class Points {
  public:
    Points(uint32_t pixels, uint32_t first, uint32_t end, uint32_t seed) : count_(end - first) {
        std::vector<SampleId> samples;
        for (uint32_t pixel = 0; pixel < pixels; ++pixel)
            for (uint32_t i = first; i < end; ++i) samples.push_back({pixel, i, seed_key(test_seed(seed))});
        words_ = words_of(samples);
    }
    // One word of a pair, for sample i of the pixel.
    uint32_t word(uint32_t pixel, uint32_t i, uint32_t pair, int axis) const {
        return words_[size_t{pixel} * count_ + i].pair[pair][axis];
    }
    // The same as a number, uniform in [0,1).
    double number(uint32_t pixel, uint32_t i, uint32_t pair, int axis) const { return word(pixel, i, pair, axis) * 0x1p-32; }

  private:
    uint32_t count_;
    std::vector<Words> words_;
};

// Counts the rectangles of 2^-i x 2^(i-k), i = 0, …, k, that do not hold exactly one of 2^k points of a pixel: every second
// sample starting with `first`.
uint32_t count_uneven(const Points& points, uint32_t pixel, uint32_t pair, uint32_t k, uint32_t first) {
    uint32_t uneven = 0;
    for (uint32_t i = 0; i <= k; ++i) {
        std::vector<uint32_t> counts(size_t{1} << k);
        for (uint32_t n = first; n < first + (2u << k); n += 2) {
            const auto column = uint64_t{points.word(pixel, n, pair, 0)} >> (32 - i),
                       row = uint64_t{points.word(pixel, n, pair, 1)} >> (32 - (k - i));
            ++counts[column << (k - i) | row];
        }
        for (const uint32_t count : counts) uneven += count != 1;
    }
    return uneven;
}

TEST(LowDiscrepancyPoints, OfEachHalfFillEveryElementaryIntervalOnce) {
    constexpr uint32_t pixels = 32;
    for (uint32_t k = 0; k <= 12; k += k < 6 ? 1 : 3) {
        // The first 2^k points of each half, and the next 2^k.
        const Points points(pixels, 0, 4u << k, 100 + k);
        for (uint32_t pixel = 0; pixel < pixels; ++pixel)
            for (uint32_t pair = 0; pair < pairs; ++pair)
                for (const uint32_t first : {0u, 1u, 2u << k, (2u << k) + 1})
                    ASSERT_EQ(count_uneven(points, pixel, pair, k, first), 0u)
                        << (1u << k) << " samples from " << first << " on of pixel " << pixel << ", pair " << pair;
    }
}

TEST(LowDiscrepancyPoints, AreUniformEachAlone) {
    // For one sample over all pixels: both lower and upper bits.
    constexpr uint32_t pixels = 1 << 20, cells = 16;
    for (const uint32_t sample : {0u, 1u, 37u, 1u << 20, 0xffffffffu}) {
        std::vector<SampleId> samples;
        for (uint32_t pixel = 0; pixel < pixels; ++pixel) samples.push_back({pixel, sample, seed_key(test_seed(120))});
        const auto words = words_of(samples);
        for (const uint32_t pair : {0u, 3u})
            for (const uint32_t shift : {28u, 20u, 8u}) {
                std::vector<uint64_t> counts(cells * cells);
                for (const Words& w : words) ++counts[(w.pair[pair].x >> shift & 15) * cells + (w.pair[pair].y >> shift & 15)];
                expect_distribution("sample " + std::to_string(sample) + ", pair " + std::to_string(pair) + ", bits from " +
                                        std::to_string(shift),
                                    counts, std::vector<double>(counts.size(), 1.0 / (cells * cells)), 0.03);
            }
    }
}

TEST(LowDiscrepancyPoints, AreUniformWithinTheirStrata) {
    // A point's position within its stratum of width 1/64: a shift shared by all points of a pixel would show in the product of
    // two of them.
    constexpr uint32_t pixels = 1 << 14, count = 64;
    const Points points(pixels, 0, 2 * count, 130);
    for (int axis = 0; axis < 2; ++axis) {
        std::vector<uint64_t> counts(64);
        for (uint32_t pixel = 0; pixel < pixels; ++pixel)
            for (uint32_t i = 0; i < 2 * count; i += 4) {
                const uint32_t first = points.word(pixel, i, 1, axis) << 6 >> 29,
                               second = points.word(pixel, i + 2, 1, axis) << 6 >> 29;
                ++counts[first * 8 + second];
            }
        expect_distribution("axis " + std::to_string(axis), counts, std::vector<double>(64, 1.0 / 64), 0.02);
    }
}

// For two words of the same 64 samples in each of many pixels: the mean square of their correlation coefficient, times 63. It is
// 1 if their orders are independent permutations. If neighbours stay together, as here, it is below 2. If one order determines
// the other, it is dozens.
template <typename First, typename Second>
MeanEstimate shared_order(uint32_t pixels, First first, Second second) {
    constexpr uint32_t count = 64;
    std::vector<double> squares;
    for (uint32_t pixel = 0; pixel < pixels; ++pixel) {
        std::vector<float> a, b;
        for (uint32_t i = 0; i < count; ++i) {
            a.push_back(static_cast<float>(first(pixel, i)));
            b.push_back(static_cast<float>(second(pixel, i)));
        }
        const double r = correlation(a, b);
        squares.push_back(r * r * (count - 1));
    }
    return estimate_mean(squares);
}

TEST(LowDiscrepancyPoints, OfDifferentPairsPixelsAndHalvesAreIndependent) {
    // Samples of even index, which share a scramble.
    constexpr uint32_t pixels = 4096, count = 64;
    const Points points(pixels + 1, 0, 2 * count, 140), other_seed(pixels, 0, 2 * count, 141);
    const auto expect_independent = [&](const std::string& what, const MeanEstimate& mean) {
        std::printf("  %s: %.3f, standard error %.3f\n", what.c_str(), mean.mean, mean.standard_error);
        EXPECT_LT(mean.mean + 5 * mean.standard_error, 2) << what;
        EXPECT_GT(mean.mean - 5 * mean.standard_error, 0.5) << what;
    };
    for (const uint32_t pair : {1u, 2u, 5u})
        for (int axis = 0; axis < 2; ++axis)
            expect_independent("pairs 0 and " + std::to_string(pair) + ", axes 0 and " + std::to_string(axis),
                               shared_order(
                                   pixels, [&](uint32_t p, uint32_t i) { return points.number(p, 2 * i, 0, 0); },
                                   [&](uint32_t p, uint32_t i) { return points.number(p, 2 * i, pair, axis); }));
    // The same number of the path for neighbouring pixels, other seeds and the other half.
    const auto own = [&](uint32_t p, uint32_t i) { return points.number(p, 2 * i, 1, 1); };
    expect_independent("neighbours",
                       shared_order(pixels, own, [&](uint32_t p, uint32_t i) { return points.number(p + 1, 2 * i, 1, 1); }));
    expect_independent("seeds",
                       shared_order(pixels, own, [&](uint32_t p, uint32_t i) { return other_seed.number(p, 2 * i, 1, 1); }));
    expect_independent("halves",
                       shared_order(pixels, own, [&](uint32_t p, uint32_t i) { return points.number(p, 2 * i + 1, 1, 1); }));
}

}  // namespace
}  // namespace lab
