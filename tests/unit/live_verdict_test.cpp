// The live verdict on simulated renders.
#include "statistics/live_verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "error.h"

namespace lab {
namespace {

constexpr uint32_t extent = 32;
constexpr double hit_probability = 0.02;  // with which a sample has radiance 1

// A noise-free reference of constant radiance.
Reference flat_reference(double mean = hit_probability) {
    Reference reference{{extent, extent, std::vector<float>(3 * extent * extent, static_cast<float>(mean))},
                        Image{extent, extent, std::vector<float>(3 * extent * extent, 1e-9f)},
                        {{"samples", "0"}}};
    return reference;
}

// A progressive render in which pixel (x,y) finds light with probability `probability(x, y)`, independently per channel.
class FakeRender {
  public:
    FakeRender(uint32_t seed, std::function<double(uint32_t, uint32_t)> probability, uint32_t scale = 1)
        : generator_(seed),
          probability_(std::move(probability)),
          film_{scale * extent, scale * extent, std::vector<FilmPixel>(scale * scale * extent * extent)} {}

    const FilmImage& advance(uint32_t samples) {
        for (uint32_t i = 0; i < film_.pixels.size(); ++i) {
            FilmPixel& pixel = film_.pixels[i];
            std::binomial_distribution<uint32_t> hits(samples - pixel.sample_count,
                                                      probability_(i % film_.width, i / film_.width));
            for (int channel = 0; channel < 3; ++channel) pixel.sum[channel] += static_cast<float>(hits(generator_));
            pixel.sample_count = samples;
        }
        return film_;
    }

  private:
    std::mt19937 generator_;
    std::function<double(uint32_t, uint32_t)> probability_;
    FilmImage film_;
};

// Tests whenever the verdict asks for it, as a viewer does, up to this many samples per pixel.
void watch(LiveVerdict& verdict, FakeRender render, uint32_t samples) {
    while (verdict.next_samples() <= samples) verdict.add(render.advance(verdict.next_samples()));
}

double unbiased(uint32_t, uint32_t) { return hit_probability; }

TEST(LiveVerdict, RaisesFalseAlarmsAsRarelyAsDesigned) {
    // For a whole render, tested five times, the last time with tiles of 8 pixels.
    constexpr double false_alarms = 0.2;
    constexpr uint32_t renders = 150;
    uint32_t alarms = 0;
    for (uint32_t seed = 1; seed <= renders; ++seed) {
        LiveVerdict verdict(flat_reference(), glm::uvec2(extent), false_alarms);
        watch(verdict, {seed, unbiased}, 2048);
        alarms += verdict.verdict()->is_biased;
    }
    std::printf("  %u of %u renders without bias called biased, at most %.0f %% designed\n", alarms, renders, 100 * false_alarms);
    EXPECT_LT(alarms, 30 + 20u) << "four standard deviations above the 30 that are designed";
    EXPECT_GT(alarms, 3u) << "it hardly ever dares to say anything";
}

TEST(LiveVerdict, FindsTheBiasThatItSaysItWouldFind) {
    LiveVerdict honest(flat_reference(), glm::uvec2(extent));
    watch(honest, {1, unbiased}, 1024);
    ASSERT_TRUE(honest.verdict());
    EXPECT_FALSE(honest.verdict()->is_biased) << honest.text();
    const double smallest = honest.verdict()->smallest_detectable[1];
    // The mean of n hits of probability p has a relative standard error of √((1-p)/(np)); a test of this level and power finds
    // 6.4 times that.
    const double standard_error = std::sqrt((1 - hit_probability) / (hit_probability * 1024 * extent * extent));
    EXPECT_NEAR(honest.verdict()->differences[1].standard_error / standard_error, 1, 0.4);
    EXPECT_GT(smallest, 5 * standard_error);
    EXPECT_LT(smallest, 11 * standard_error);

    uint32_t found = 0;
    for (uint32_t seed = 1; seed <= 20; ++seed) {
        LiveVerdict verdict(flat_reference(), glm::uvec2(extent));
        watch(verdict, {seed, [&](uint32_t, uint32_t) { return (1 - smallest) * hit_probability; }}, 1024);
        found += verdict.verdict()->is_biased;
    }
    EXPECT_GE(found, 18u) << "of 20";
}

TEST(LiveVerdict, SaysHowLargeTheBiasIsAndWhere) {
    // The left half is 30 % too dark, so the whole image is 15 % too dark.
    const auto left_too_dark = [](uint32_t x, uint32_t) { return (x < extent / 2 ? 0.7 : 1) * hit_probability; };
    LiveVerdict verdict(flat_reference(), glm::uvec2(extent));
    watch(verdict, {1, left_too_dark}, 2048);
    ASSERT_TRUE(verdict.verdict()->is_biased);
    const Difference& green = verdict.verdict()->differences[1];
    EXPECT_NEAR(green.value, -0.15, 5 * green.standard_error);
    EXPECT_LT(green.standard_error, 0.01);
    EXPECT_EQ(verdict.verdict()->tile_size, 8u);
    EXPECT_EQ(verdict.verdict()->tiles, 16u);
    EXPECT_EQ(verdict.verdict()->dark_tiles, 8u);
    EXPECT_EQ(verdict.verdict()->bright_tiles, 0u);
    const ZMap& map = verdict.verdict()->map;
    ASSERT_EQ(map.values.size(), 16u);
    for (uint32_t i = 0; i < 16; ++i) {
        EXPECT_EQ(map.values[i] < -5, i % 4 < 2) << "tile " << i;
        const Difference& tile = verdict.verdict()->map_differences[i];
        EXPECT_NEAR(tile.value, i % 4 < 2 ? -0.3 : 0, 5 * tile.standard_error) << "tile " << i;
        EXPECT_LT(tile.standard_error, 0.03) << "tile " << i;
    }
}

TEST(LiveVerdict, SaysItInOneLine) {
    Verdict verdict;
    verdict.smallest_detectable = {0.004, 0.0081, 0.006};
    EXPECT_EQ(to_text(verdict), "agrees with the reference: a bias above 0.81 % would show by now");
    verdict.is_biased = true;
    verdict.differences = {{{-0.14, 0.006, 63}, {0.012, 0.0004, 63}, {0, 0.05, 63}}};
    EXPECT_EQ(to_text(verdict), "biased: red -14 % ± 1 %, green +1.20 % ± 0.08 %, blue +0 % ± 10 %");
    verdict.tile_size = 32;
    verdict.tiles = 256;
    verdict.dark_tiles = 31;
    EXPECT_EQ(to_text(verdict),
              "biased: red -14 % ± 1 %, green +1.20 % ± 0.08 %, blue +0 % ± 10 %; of 256 tiles of 32 pixels, 0 "
              "are too bright and 31 too dark");
}

TEST(LiveVerdict, SeesTilesThatCancelEachOther) {
    const auto chequered = [](uint32_t x, uint32_t) { return (x < extent / 2 ? 0.8 : 1.2) * hit_probability; };
    LiveVerdict verdict(flat_reference(), glm::uvec2(extent));
    watch(verdict, {1, chequered}, 2048);
    EXPECT_TRUE(verdict.verdict()->is_biased);
    EXPECT_EQ(verdict.verdict()->dark_tiles, 8u);
    EXPECT_EQ(verdict.verdict()->bright_tiles, 8u);
}

TEST(LiveVerdict, TakesImagesLargerThanTheReference) {
    LiveVerdict verdict(flat_reference(), glm::uvec2(4 * extent));
    watch(verdict, {1, unbiased, 4}, 128);
    EXPECT_FALSE(verdict.verdict()->is_biased) << verdict.text();
    EXPECT_EQ(verdict.verdict()->tile_size, 32u);
    LiveVerdict of_dark(flat_reference(), glm::uvec2(4 * extent));
    watch(of_dark, {1, [](uint32_t, uint32_t) { return 0.5 * hit_probability; }, 4}, 16);
    EXPECT_TRUE(of_dark.verdict()->is_biased);
    EXPECT_EQ(of_dark.verdict()->samples, 16u);
    EXPECT_THROW(LiveVerdict(flat_reference(), {48, 48}), UserError);
    EXPECT_THROW(LiveVerdict(flat_reference(), {64, 32}), UserError);
}

TEST(LiveVerdict, SaysNothingOfATileOfOnePixel) {
    // Tiles have 8 x 8 pixels, and a single one has no spread.
    Reference reference{{9, 9, std::vector<float>(3 * 9 * 9, 0.5f)}, std::nullopt, {}};
    FilmImage film{9, 9, std::vector<FilmPixel>(9 * 9)};
    LiveVerdict verdict(std::move(reference), {9, 9});
    std::mt19937 generator(1);
    for (FilmPixel& pixel : film.pixels) {
        std::binomial_distribution<uint32_t> hits(verdict.next_samples(), 0.5);
        pixel.sum = vec3(static_cast<float>(hits(generator)));
        pixel.sample_count = verdict.next_samples();
    }
    verdict.add(film);
    EXPECT_FALSE(verdict.verdict()->is_biased) << verdict.text();
    for (const double z : verdict.verdict()->map.values) EXPECT_LT(std::abs(z), 5);
}

TEST(LiveVerdict, WaitsForEnoughPaths) {
    LiveVerdict verdict(flat_reference(), glm::uvec2(extent));
    watch(verdict, {1, [](uint32_t, uint32_t) { return 0.1; }}, 64);  // 2^16 paths
    EXPECT_FALSE(verdict.verdict());
    EXPECT_NE(verdict.text().find("no verdict"), std::string::npos);
}

TEST(LiveVerdict, SeesABlackImage) {
    Reference reference = flat_reference();
    reference.attributes["samples"] = "65536";  // a sample then has a variance of 6.6e-5
    LiveVerdict verdict(std::move(reference), glm::uvec2(extent));
    watch(verdict, {1, [](uint32_t, uint32_t) { return 0.0; }}, 128);
    EXPECT_TRUE(verdict.verdict()->is_biased);
    EXPECT_NEAR(verdict.verdict()->differences[0].value, -1, 1e-6);
}

}  // namespace
}  // namespace lab
