// shaders/world/random.glsl: the generator, its start states, and the independence of samples.
#include <algorithm>
#include <cmath>

#include "rendering/renderer.h"
#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/pcg2d.h"

namespace lab {
namespace {

// Layout as in random.comp.
struct StreamId {
    uint32_t pixel;
    uint32_t sample;
    RandomState key;
};

RandomState key_of_seed(uint32_t seed) {
    const uvec2 key = seed_key(test_seed(seed));
    return {key.x, key.y};
}

// States around 8, 16, 24 and 32 bits, and a million spread over the whole range.
std::vector<RandomState> hard_states() {
    const uint32_t hard[] = {0, 1, 2, 0xff, 0x100, 0xffff, 0x10000, 0x7fffffff, 0x80000000, 0xffffff00, 0xffffffff};
    std::vector<RandomState> states;
    for (const uint32_t x : hard)
        for (const uint32_t y : hard) states.push_back({x, y});
    for (uint32_t i = 0; i < 1 << 20; ++i) states.push_back({i * 2654435769u, i ^ (i << 13)});
    return states;
}

TEST(RandomNumbers, AreThoseOfThePaper) {
    const auto states = hard_states();
    const auto next = run_shader<RandomState>({"random.comp", {"NEXT_STATES"}}, states);
    for (size_t i = 0; i < states.size(); ++i) {
        ASSERT_EQ(next[i], next_state(states[i]));
        ASSERT_EQ(previous_state(next[i]), states[i]);
    }
}

TEST(RandomNumbers, StayBelowOneAtTheExtremes) {
    struct Numbers {
        float u[2];
    };
    // The start state is a bijection, so any number can be produced: here those next to 0 and 1.
    std::vector<StreamId> streams;
    const auto states = hard_states();
    for (const RandomState& state : states) {
        const auto [pixel, sample] = pixel_and_sample(previous_state(state), {0, 0});
        streams.push_back({pixel, sample, {0, 0}});
    }
    const auto results = run_shader<Numbers>({"random.comp", {"NUMBERS 1"}}, streams);
    for (size_t i = 0; i < states.size(); ++i)
        for (size_t k = 0; k < 2; ++k) {
            ASSERT_GE(results[i].u[k], 0.0f);
            ASSERT_LT(results[i].u[k], 1.0f);
            ASSERT_EQ(double{results[i].u[k]}, numbers_of_state(states[i])[k]);
        }
    record("largest_number", "1 - 2^-24");
}

TEST(RandomNumbers, LetHappenWhatIsAsProbableAsItSays) {
    struct Event {
        RandomState state;
        float probability;
    };
    // Of the 2^64 pairs of words, those below the probability times 2^64. Below 2^-40 it is rounded down to a multiple of 2^-64.
    std::vector<Event> events;
    std::vector<uint32_t> expected;
    for (const float probability :
         {1.0f, 1 - 0x1p-24f, 0.95f, 0.5f, 0.3f, 0.001f, 1e-6f, 0x1p-24f, 1e-9f, 0x1p-32f, 1e-12f, 1e-18f, 0x1p-64f}) {
        const auto count = static_cast<uint64_t>(std::min(probability * 0x1p64, 0x1p64 - 2048));
        for (const uint64_t bits : {uint64_t{0}, count - 1, count, count + 1, ~uint64_t{0}}) {
            events.push_back({state_before(bits), probability});
            expected.push_back(probability == 1 || bits < count);
        }
    }
    events.push_back({state_before(uint64_t{0}), 0.0f});
    expected.push_back(0);
    const auto happened = run_shader<uint32_t>({"random.comp", {"HAPPENS"}}, events);
    for (size_t i = 0; i < events.size(); ++i)
        EXPECT_EQ(happened[i], expected[i]) << "probability " << events[i].probability << ", case " << i % 5;
}

TEST(StartStates, AreDistinct) {
    // 2^22 samples as in real images: many pixels with few samples, and few pixels with many.
    std::vector<StreamId> streams;
    const RandomState key = key_of_seed(1);
    for (uint32_t i = 0; i < 1 << 21; ++i) {
        streams.push_back({i >> 2, i & 3, key});
        streams.push_back({i & 7, 4 + (i >> 3), key});
    }
    // And at the end of the 32-bit range: the last pixels of the largest image, the middle and the last of all samples.
    for (uint32_t i = 0; i < 1 << 15; ++i)
        for (const uint32_t pixel : {(1u << 28) - 1, (1u << 28) - 2}) {
            streams.push_back({pixel, 0x7fffffffu + i, key});
            streams.push_back({pixel, 0xffffffffu - i, key});
        }
    auto states = run_shader<RandomState>({"random.comp", {"START_STATES"}}, streams);
    for (size_t i = 0; i < streams.size(); ++i) {
        const auto [pixel, sample, stream_key] = streams[i];
        ASSERT_EQ(states[i], start_state(pixel, sample, stream_key));
        ASSERT_EQ(pixel_and_sample(states[i], stream_key), (RandomState{pixel, sample}));
    }
    std::sort(states.begin(), states.end());
    EXPECT_EQ(std::adjacent_find(states.begin(), states.end()), states.end());
    record("states_that_occur_twice", "0 of %zu", states.size());
}

// Numbers of all pixels of an image, as one series per sample, seed and dimension.
class Streams {
  public:
    static constexpr uint32_t width = 512, height = 288, pixels = width * height;
    static constexpr uint32_t samples = 3, seeds = 2, dimensions = 8;

    Streams() : series_(size_t{seeds} * samples * dimensions, std::vector<float>(pixels)) {
        struct Numbers {
            float u[dimensions];
        };
        for (uint32_t seed = 0; seed < seeds; ++seed)
            for (uint32_t sample = 0; sample < samples; ++sample) {
                std::vector<StreamId> streams;
                for (uint32_t pixel = 0; pixel < pixels; ++pixel) streams.push_back({pixel, sample, key_of_seed(1 + seed)});
                const auto numbers = run_shader<Numbers>({"random.comp", {"NUMBERS 4"}}, streams);
                for (uint32_t dimension = 0; dimension < dimensions; ++dimension)
                    for (uint32_t pixel = 0; pixel < pixels; ++pixel)
                        series_[index(seed, sample, dimension)][pixel] = numbers[pixel].u[dimension];
            }
    }

    // Pairs of numbers at these distances in pixel, sample and seed.
    struct Lag {
        const char* name;
        uint32_t pixel, sample, seed;
    };
    static constexpr Lag lags[] = {{"within a sample", 0, 0, 0},
                                   {"right neighbour", 1, 0, 0},
                                   {"lower neighbour", width, 0, 0},
                                   {"64 rows below", 64 * width, 0, 0},
                                   {"next sample", 0, 1, 0},
                                   {"second next sample", 0, 2, 0},
                                   {"next seed", 0, 0, 1}};

    std::span<const float> first(const Lag& lag, uint32_t dimension) const {
        return std::span(series_[index(0, 0, dimension)]).first(pixels - lag.pixel);
    }
    std::span<const float> second(const Lag& lag, uint32_t dimension) const {
        return std::span(series_[index(lag.seed, lag.sample, dimension)]).subspan(lag.pixel);
    }

  private:
    static size_t index(uint32_t seed, uint32_t sample, uint32_t dimension) {
        return (size_t{seed} * samples + sample) * dimensions + dimension;
    }
    std::vector<std::vector<float>> series_;
};

// Difference of the correlation coefficient of two series from 0.
Difference difference_of_correlation(std::span<const float> first, std::span<const float> second) {
    const double count = static_cast<double>(first.size());
    return {correlation(first, second), 1 / std::sqrt(count), count - 2};
}

TEST(RandomNumbers, AreNotCorrelated) {
    const Streams streams;
    double largest = 0;
    for (const auto& lag : Streams::lags) {
        std::vector<Difference> correlations;
        for (uint32_t i = 0; i < Streams::dimensions; ++i)
            for (uint32_t j = 0; j < Streams::dimensions; ++j) {
                if (&lag == Streams::lags && i == j) continue;
                correlations.push_back(difference_of_correlation(streams.first(lag, i), streams.second(lag, j)));
                largest = std::max(largest, std::abs(correlations.back().value));
            }
        expect_no_difference(std::string("correlation, ") + lag.name, correlations, 0.025);
    }
    record("largest_correlation", "%.4f of %u pairs", largest, Streams::pixels);
}

TEST(RandomNumbers, FillTheSquareEvenly) {
    // Pairs of numbers in 64 x 64 cells: non-linear correlations show here.
    const Streams streams;
    constexpr size_t cells = 64;
    const std::vector<double> even(cells * cells, 1.0 / (cells * cells));
    for (const auto& lag : Streams::lags)
        for (const auto& [i, j] : {std::pair{0u, 1u}, {1u, 2u}, {3u, 7u}}) {
            std::vector<uint64_t> counts(even.size());
            const auto x = streams.first(lag, i), y = streams.second(lag, j);
            for (size_t k = 0; k < x.size(); ++k)
                ++counts[static_cast<size_t>(x[k] * cells) * cells + static_cast<size_t>(y[k] * cells)];
            expect_distribution(std::string(lag.name) + ", dimensions " + std::to_string(i) + " and " + std::to_string(j), counts,
                                even, 0.08);
        }
}

TEST(RandomNumbers, OfPixelsMakeIndependentImages) {
    // The variance of an image's mean is that of a pixel over the number of pixels only if pixels are independent. Shared random
    // numbers (pixel + 2^16 * frame) show as a wrong ratio.
    constexpr uint32_t images = 1 << 16, pixels = 256;
    std::vector<StreamId> inputs;
    for (uint32_t image = 0; image < images; ++image) inputs.push_back({pixels, image, key_of_seed(3)});
    struct Sums {
        float sum, sum_of_squares;
    };
    const auto sums = run_shader<Sums>({"random.comp"}, inputs);
    std::vector<double> image_means, pixel_variances, ratio_terms;
    for (const auto& [sum, sum_of_squares] : sums) {
        const double mean = sum / pixels;
        image_means.push_back(mean);
        pixel_variances.push_back((sum_of_squares / pixels - mean * mean) * pixels / (pixels - 1));
    }
    const MeanEstimate mean = estimate_mean(image_means);
    const double expected_variance = estimate_mean(pixel_variances).mean / pixels;
    for (const double image_mean : image_means)
        ratio_terms.push_back((image_mean - mean.mean) * (image_mean - mean.mean) / expected_variance);
    expect_mean("variance of the image mean / that of independent pixels", estimate_mean(ratio_terms), 1, 0.05);
    // Sums over successive images, which use successive samples, are independent as well.
    const std::vector<float> means(image_means.begin(), image_means.end());
    expect_no_difference("correlation of successive images",
                         std::vector{difference_of_correlation(std::span(means).first(images - 1), std::span(means).subspan(1))},
                         0.03);
}

}  // namespace
}  // namespace lab
