// The film file.
#include "film/film_file.h"

#include <gtest/gtest.h>

#include <random>

#include "film/film_image.h"
#include "test_files.h"

namespace lab {
namespace {

TEST(FilmFile, GoesOnWithTheWholeSum) {
    // A mean times a number of samples needs more digits than a float has.
    constexpr uint32_t samples = 11;
    std::mt19937 generator(1);
    std::uniform_real_distribution<float> radiance(0, 2);
    FilmImage film{50, 1, std::vector<FilmPixel>(50)};
    for (FilmPixel& pixel : film.pixels) {
        pixel.sum = vec3(radiance(generator), radiance(generator), radiance(generator));
        pixel.sample_count = samples;
    }
    const TestFolder folder;
    write_film(folder / "film.exr", film, {});
    const Image mean = film.mean();
    const FilmImage read = read_film(folder / "film.exr").image;
    for (size_t i = 0; i < film.pixels.size(); ++i)
        for (int channel = 0; channel < 3; ++channel) {
            const double sum = sum_of(read.pixels[i])[channel];
            EXPECT_EQ(sum, samples * double{mean.pixels[3 * i + channel]});
        }
}

TEST(FilmFile, KeepsThePixelsOfALargeImageThatDiffer) {
    const TestFolder folder;
    FilmImage film{400, 300, std::vector<FilmPixel>(400 * 300, {vec3(5), vec3(0), vec3(0), 5, 0})};
    film.pixels[70'000].sample_count = 4;  // threads work on pieces of 65,536
    film.pixels[119'999].invalid_count = 1;
    EXPECT_EQ(film.min_samples(), 4u);
    EXPECT_TRUE(film.exceeds(film.min_samples()));
    write_film(folder / "film.exr", film, {});
    const FilmImage read = read_film(folder / "film.exr").image;
    for (size_t i = 0; i < film.pixels.size(); ++i) {
        ASSERT_EQ(read.pixels[i].sample_count, film.pixels[i].sample_count) << i;
        ASSERT_EQ(read.pixels[i].invalid_count, film.pixels[i].invalid_count) << i;
    }
}

TEST(FilmFile, RangesJoinWithoutOverlapOrGap) {
    const TestFolder folder;
    const auto write = [&](uint32_t first, uint32_t samples) {
        FilmHeader header{};
        header.first_sample = first;
        const auto file = folder / (std::to_string(first) + "_" + std::to_string(samples) + ".exr");
        write_film(file, {1, 1, {{vec3(1), vec3(0), vec3(0), samples, 0}}}, header);
        return file;
    };
    const uint32_t half = 0x80000000;
    const auto first = write(0, half), rest = write(half, half - 1);
    // In any order; and a pixel's sample count needs all 32 bits.
    const FilmFile merged = merge_films({rest, first});
    EXPECT_EQ(merged.header.first_sample, 0u);
    EXPECT_EQ(merged.image.min_samples(), 0xffffffffu);
    EXPECT_USER_ERROR(merge_films({first, write(half, half)}), "at most 2^32 - 1 samples");
    EXPECT_USER_ERROR(merge_films({first, write(half + 1, 7)}), "without overlap or gap");
    EXPECT_USER_ERROR(merge_films({first, write(half - 1, 7)}), "without overlap or gap");
}

TEST(FilmFile, NumbersThatNoRenderWritesAreRefused) {
    const TestFolder folder;
    const auto file = folder / "film.exr";
    const auto refuse = [&](const std::string& part, const std::function<void(ExrFile&)>& change) {
        write_film(file, {1, 1, {{vec3(1), vec3(0), vec3(0), 5, 1}}}, {});
        ExrFile exr = read_exr(file);
        change(exr);
        write_exr(file, exr);
        EXPECT_USER_ERROR(read_film(file), part);
    };
    constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const char* seconds : {"nan", "inf", "-1"})
        refuse("seconds are negative or not finite", [&](ExrFile& exr) { exr.attributes["seconds"] = seconds; });
    for (const float number : {infinity, nan, 3e38f}) {  // the last one overflows, five times
        refuse("infinite pixels", [&](ExrFile& exr) { exr.image.pixels[1] = number; });
        refuse("infinite pixels", [&](ExrFile& exr) { exr.channels["difference.B"] = {number}; });
    }
    refuse("more samples than there are", [&](ExrFile& exr) {
        exr.attributes["samples"] = "4294967295";
        exr.channels["further_samples"] = {1};
    });
    refuse("more samples than there are", [&](ExrFile& exr) { exr.attributes["first_sample"] = "4294967292"; });
    refuse("more invalid samples than samples", [&](ExrFile& exr) { exr.channels["invalid_samples"] = {6}; });
}

// An invalid sample adds nothing but is counted, and its pixel is magenta.
TEST(FilmFile, KeepsAndShowsInvalidSamples) {
    const TestFolder folder;
    for (const uint32_t first : {0u, 5u}) {
        FilmHeader header{};
        header.first_sample = first;
        const FilmPixel good{vec3(1), vec3(0), vec3(0), 5, 0}, bad{vec3(1), vec3(0), vec3(0), 5, first == 0};
        write_film(folder / (std::to_string(first) + ".exr"), {2, 1, {good, bad}}, header);
    }
    const FilmImage film = merge_films({folder / "0.exr", folder / "5.exr"}).image;
    EXPECT_EQ(film.pixels[0].invalid_count, 0u);
    EXPECT_EQ(film.pixels[1].invalid_count, 1u);
    EXPECT_EQ(film.pixels[1].sample_count, 10u);
    for (const auto transform : {DisplayTransform::exposure, DisplayTransform::maximum, DisplayTransform::as_is}) {
        const auto shown = to_display(film, transform, 0).pixels;
        const std::vector<uint8_t> magenta{255, 0, 255};
        EXPECT_NE(std::vector(shown.begin(), shown.begin() + 3), magenta);
        EXPECT_EQ(std::vector(shown.begin() + 4, shown.begin() + 7), magenta);
    }
}

}  // namespace
}  // namespace lab
