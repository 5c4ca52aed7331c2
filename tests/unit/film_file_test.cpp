// The film as a file.
#include "film/film_file.h"

#include <gtest/gtest.h>

#include <random>

#include "test_files.h"

namespace lab {
namespace {

TEST(FilmFile, GoesOnWithTheWholeSum) {
    // A mean times a number of samples takes more digits than a float has.
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

}  // namespace
}  // namespace lab
