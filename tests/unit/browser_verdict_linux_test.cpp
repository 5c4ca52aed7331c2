// The verdict of the book's pages, in JavaScript, is that of C++: both judge the same films.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>

#include "files/file.h"
#include "statistics/live_verdict.h"
#include "unit/page_answer.h"
#include "unit/test_files.h"

namespace lab {
namespace {

using nlohmann::json;

constexpr uint32_t reference_width = 52, reference_height = 44;  // no whole number of tiles
constexpr uint32_t times = 2;

Reference noisy_reference(std::mt19937& random) {
    std::normal_distribution<float> noise(0, 1);
    Reference reference{
        {reference_width, reference_height, {}}, Image{reference_width, reference_height, {}}, {{"samples", "512"}}};
    for (uint32_t i = 0; i < 3 * reference_width * reference_height; ++i) {
        const float mean = i % 97 == 0 ? 0 : 0.2f + 0.1f * static_cast<float>(i % 3);
        reference.variance->pixels.push_back(mean * 1e-4f);
        reference.mean.pixels.push_back(std::max(mean + std::sqrt(reference.variance->pixels.back()) * noise(random), 0.0f));
    }
    return reference;
}

// The film after `samples` a pixel; `bias` makes the left part of the picture too bright.
FilmImage noisy_film(const Reference& reference, uint32_t samples, float bias, std::mt19937& random) {
    FilmImage film{times * reference_width, times * reference_height, {}};
    std::normal_distribution<float> noise(0, 1);
    const float count = static_cast<float>(samples);
    for (uint32_t y = 0; y < film.height; ++y)
        for (uint32_t x = 0; x < film.width; ++x) {
            FilmPixel pixel{};
            pixel.sample_count = samples;
            for (int channel = 0; channel < 3; ++channel) {
                const float mean =
                    reference.mean.pixels[3 * (y / times * reference_width + x / times) + static_cast<uint32_t>(channel)];
                const float factor = x < film.width / 3 ? 1 + bias : 1;
                pixel.sum[channel] = count * (factor * mean + 0.2f * noise(random) / std::sqrt(count));
            }
            film.pixels.push_back(pixel);
        }
    return film;
}

json to_json(const Reference& reference) {
    return {{"width", reference_width},
            {"height", reference_height},
            {"samples", 512},
            {"mean", reference.mean.pixels},
            {"variance", reference.variance->pixels}};
}

json to_json(const FilmImage& film) {
    std::vector<float> sums;
    for (const FilmPixel& pixel : film.pixels) sums.insert(sums.end(), {pixel.sum.x, pixel.sum.y, pixel.sum.z});
    return {{"width", film.width}, {"height", film.height}, {"samples", film.min_samples()}, {"sums", sums}};
}

void expect_near(const json& page, double expected, const char* what) {
    EXPECT_NEAR(page.get<double>(), expected, 1e-9 * std::max(1.0, std::abs(expected))) << what;
}

TEST(BrowserVerdict, IsThatOfThePrograms) {
    if (!has_node()) GTEST_SKIP() << "node is missing";
    for (const float bias : {0.0f, 0.02f, 0.3f}) {
        std::mt19937 random(7);
        const Reference reference = noisy_reference(random);
        LiveVerdict verdict(reference, uvec2(times * reference_width, times * reference_height));
        json task{{"reference", to_json(reference)}, {"films", json::array()}};
        std::vector<Verdict> expected;
        std::vector<std::string> texts;
        for (int look = 0; look < 3; ++look) {
            const FilmImage film = noisy_film(reference, verdict.next_samples(), bias, random);
            task["films"].push_back(to_json(film));
            verdict.add(film);
            expected.push_back(*verdict.verdict());
            texts.push_back(verdict.text());
        }
        const json page = answer_of_page("verdict", task);
        ASSERT_EQ(page.size(), expected.size());
        for (size_t look = 0; look < expected.size(); ++look) {
            EXPECT_EQ(page[look]["text"], texts[look]) << "bias " << bias;
            EXPECT_EQ(page[look]["isBiased"], expected[look].is_biased);
            for (size_t channel = 0; channel < 3; ++channel) {
                expect_near(page[look]["values"][channel], expected[look].differences[channel].value, "difference");
                expect_near(page[look]["errors"][channel], expected[look].differences[channel].standard_error, "standard error");
                expect_near(page[look]["smallestDetectable"][channel], expected[look].smallest_detectable[channel],
                            "smallest bias");
            }
            ASSERT_EQ(page[look]["map"].size(), expected[look].map.values.size());
            for (size_t i = 0; i < expected[look].map.values.size(); ++i)
                expect_near(page[look]["map"][i], expected[look].map.values[i], "map");
        }
        EXPECT_EQ(expected.back().is_biased, bias > 0);  // or the comparison would say little
    }
}

}  // namespace
}  // namespace lab
