// Sample indices up to 2^32: no two samples of an image share their random numbers, also not the last ones.
#include <algorithm>
#include <set>

#include "error.h"
#include "film/film_file.h"
#include "support/gpu_test.h"
#include "support/pcg2d.h"
#include "support/render.h"

namespace lab {
namespace {

TEST(SampleIndices, StartStatesAreABijectionAtTheTopOfTheRange) {
    // start_state() is invertible for every pixel and sample: so it is a bijection. Here the device's is the
    // same function where numbers of 32 bits end, and these states are not those of the first samples.
    struct Stream {
        uint32_t pixel, sample;
        RandomState key;
    };
    constexpr uint32_t last_pixel = (1u << 28) - 1;  // of the largest image, 16384 x 16384
    std::vector<Stream> streams;
    for (const RandomState key : {RandomState{0, 0}, RandomState{0xffffffff, 0xffffffff}, RandomState{1, 2}})
        for (const uint32_t pixel : {0u, 1u, last_pixel})
            for (uint32_t i = 0; i < 1 << 15; ++i) {
                streams.push_back({pixel, i, key});
                streams.push_back({pixel, 0x7fffffffu + i, key});
                streams.push_back({pixel, 0xffffffffu - i, key});
            }
    auto states = run_shader<RandomState>({"random.comp", {"START_STATES"}}, streams);
    const size_t states_of_a_key = streams.size() / 3;
    for (size_t i = 0; i < streams.size(); ++i) {
        const auto& [pixel, sample, key] = streams[i];
        ASSERT_EQ(states[i], start_state(pixel, sample, key));
        ASSERT_EQ(pixel_and_sample(states[i], key), (RandomState{pixel, sample}));
    }
    for (size_t first = 0; first < states.size(); first += states_of_a_key) {
        const auto begin = states.begin() + static_cast<std::ptrdiff_t>(first),
                   end = begin + static_cast<std::ptrdiff_t>(states_of_a_key);
        std::sort(begin, end);
        ASSERT_EQ(std::adjacent_find(begin, end), end);
    }
    record("states_that_occur_twice", "0 of %zu", states.size());
}

class SampleIndexCases : public OnEachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, SampleIndexCases, testing::ValuesIn(all_backends), backend_name);

TEST_P(SampleIndexCases, TheLastSamplesAreRenderedAsAnyOthers) {
    constexpr uint32_t count = 8, last = 0xffffffff;
    const Scene scene = load_shipped_scene("cornell_box.json");
    RenderSettings settings{.width = 24, .height = 20, .samples = count, .backend = GetParam()};
    settings.first_sample = last - count + 1;
    SceneRenderer renderer(scene, settings);
    const FilmImage whole = renderer.render(settings).film;
    settings.samples = 1;
    const auto render_sample = [&](uint32_t index) {
        settings.first_sample = index;
        return renderer.render(settings).film;
    };
    std::vector<glm::dvec3> sums(whole.pixels.size());
    std::set<std::vector<double>> images;
    std::vector<uint32_t> others;  // into which the last ones would run over if an index had fewer bits
    for (uint32_t i = 0; i < count; ++i) {
        const FilmImage film = render_sample(last - i);
        images.insert(pixel_means(film, 0));
        for (size_t p = 0; p < sums.size(); ++p) sums[p] += glm::dvec3(film.pixels[p].sum);
        others.push_back(i);
    }
    for (const int bits : {8, 15, 16, 23, 24, 31})
        others.insert(others.end(), {1u << bits, (1u << bits) - 1});
    for (const uint32_t index : others) images.insert(pixel_means(render_sample(index), 0));
    EXPECT_EQ(images.size(), count + others.size());
    for (size_t p = 0; p < sums.size(); ++p)
        ASSERT_LE(glm::distance(glm::dvec3(whole.pixels[p].sum), sums[p]), 1e-6 * glm::length(sums[p]));
}

TEST(SampleIndices, MergedRangesEndBelowTheRange) {
    // A pixel counts its samples in 32 bits; parts that have more together are refused instead of starting
    // over at 0.
    const auto file = [](const std::string& name) {
        return std::filesystem::path(testing::TempDir()) / (std::to_string(getpid()) + name);
    };
    const auto write = [&](const std::string& name, uint32_t first, uint32_t samples) {
        FilmRecord record{};
        record.first_sample = first;
        write_film(
            file(name),
            {1,
             1,
             {FilmPixel{
                 .sum = vec3(1), .compensation = vec3(0), .sample_count = samples, .invalid_count = 0}}},
            record);
        return file(name);
    };
    const auto first = write("first.exr", 0, 0x80000000), fits = write("fits.exr", 0x80000000, 0x7fffffff),
               too_many = write("too_many.exr", 0x80000000, 0x80000000);
    EXPECT_EQ(merge_films({first, fits}).image.min_samples(), 0xffffffffu);
    EXPECT_THROW(merge_films({first, too_many}), UserError);
    for (const auto& path : {first, fits, too_many}) std::filesystem::remove(path);
}

}  // namespace
}  // namespace lab
