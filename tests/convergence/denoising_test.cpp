// Chapter 16: what the filters do to pictures made by hand, and how well their errors are known.
#include <cmath>
#include <functional>
#include <random>

#include "files/project_folder.h"
#include "support/filters.h"
#include "support/gpu_test.h"

namespace lab {
namespace {

// Sets every pixel, with independent normal noise of this standard deviation in each half, which the filter knows.
void fill(MadeFilms& films, const std::function<vec3(uint32_t x, uint32_t y)>& value, float noise = 0) {
    std::mt19937 engine(1);
    std::normal_distribution<float> normal(0, noise > 0 ? noise : 1);
    const auto number = [&] { return noise > 0 ? normal(engine) : 0.0f; };
    for (uint32_t y = 0; y < films.films[FILM_NOW].height; ++y)
        for (uint32_t x = 0; x < films.films[FILM_NOW].width; ++x) {
            const vec3 mean = value(x, y);
            films.set(x, y, {mean + vec3(number(), number(), number()), mean + vec3(number(), number(), number())},
                      noise * noise);
        }
}

// The weights of the joint bilateral filter along a row, which do not depend on the picture.
std::vector<double> bilateral_weights() {
    std::vector<double> weights;
    double sum = 0;
    for (int x = -7; x <= 7; ++x) sum += weights.emplace_back(std::exp(-0.5 * x * x / 16.0));
    for (double& weight : weights) weight /= sum;
    return weights;
}

// Filters that measure differences in units of the noise.
class ConsistentFilters : public testing::TestWithParam<const char*> {};

// To the bit: without noise every difference counts.
TEST_P(ConsistentFilters, KeepAPictureWithoutNoise) {
    MadeFilms films(32);
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> uniform(0, 1);
    fill(films, [&](uint32_t, uint32_t) { return vec3(uniform(engine), uniform(engine), uniform(engine)); });
    EXPECT_EQ(films.filter(GetParam()).mean().pixels, films.films[FILM_NOW].mean().pixels);
}

// An edge that the noise does not hide stays: three standard deviations of a half.
TEST_P(ConsistentFilters, KeepEdgesThatStandOutOfTheNoise) {
    MadeFilms films(128);
    const auto value = [](uint32_t x, uint32_t) { return vec3(x < 64 ? 1.0f : 1.3f); };
    fill(films, value, 0.1f);
    const Image filtered = films.filter(GetParam()).mean();
    double bias = 0;
    for (uint32_t y = 0; y < 128; ++y)
        for (uint32_t x = 60; x < 64; ++x) bias += (filtered.pixels[3 * (size_t{y} * 128 + x)] - 1.0) / (128 * 4);
    record("edge_bias", "%.4f", bias);
    EXPECT_NEAR(bias, 0, 0.02);
    double variance = 0;
    for (uint32_t y = 0; y < 128; ++y)
        for (uint32_t x = 0; x < 56; ++x) variance += std::pow(filtered.pixels[3 * (size_t{y} * 128 + x)] - 1.0, 2) / (128 * 56);
    record("noise_left", "%.4f", std::sqrt(variance / 0.005));  // that of both halves together was 0.1 / √2
    EXPECT_LE(variance / 0.005, 0.1);
    // A filter that believed in more noise than there is would leave less: squares of weights matter for à-trous, whose passes
    // pass it on.
    EXPECT_GE(variance / 0.005, 0.002);
}

// The image of a small lamp covers only some of the samples of a pixel, so its variance is large. That does not make it light of
// its dark neighbours.
TEST_P(ConsistentFilters, KeepBrightSpotsToThemselves) {
    MadeFilms films(32);
    fill(
        films, [](uint32_t, uint32_t) { return vec3(0.01f); }, 0.002f);
    films.set(16, 16, {vec3(60), vec3(60)}, 5000);
    const Image filtered = films.filter(GetParam()).mean();
    for (size_t i = 0; i < filtered.pixels.size(); ++i) {
        if (i / 3 == 16 * 32 + 16) continue;
        ASSERT_LE(filtered.pixels[i], 0.02f) << "number " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Filters, ConsistentFilters, testing::Values("a_trous", "nl_means"),
                         [](const auto& info) { return std::string(info.param); });

// The variance of a weighted mean of independent values is Σ w² times theirs.
TEST(Filters, AverageFlatNoise) {
    constexpr uint32_t size = 256, border = 8;
    MadeFilms films(size);
    fill(
        films, [](uint32_t, uint32_t) { return vec3(1); }, 0.1f);
    const FilmImage filtered = films.filter("bilateral");
    double squares = 0, sum = 0;
    for (uint32_t y = border; y < size - border; ++y)
        for (uint32_t x = border; x < size - border; ++x) {
            const FilmPixel& pixel = filtered.pixels[size_t{y} * size + x];
            const glm::dvec3 difference = difference_of_halves(pixel);
            squares += glm::dot(difference * difference, glm::dvec3(1.0 / 6));  // the variance of a half
            sum += sum_of(pixel).r / pixel.sample_count;
        }
    const double count = (size - 2 * border) * (size - 2 * border);
    double weights = 0;
    for (const double weight : bilateral_weights()) weights += weight * weight;
    record("variance", "%.3e, expected %.3e", squares / count, 0.01 * weights * weights);
    EXPECT_NEAR(squares / count / (0.01 * weights * weights), 1, 0.1);
    EXPECT_NEAR(sum / count, 1, 0.002);
}

// The bias at a step is its height times the share of the weights on the other side.
TEST(Filters, BlurAStepByTheShareOfItsWeights) {
    MadeFilms films(32);
    fill(films, [](uint32_t x, uint32_t) { return vec3(x < 16 ? 1.0f : 3.0f); });
    const Image filtered = films.filter("bilateral").mean();
    const std::vector<double> weights = bilateral_weights();
    for (int x = 8; x < 24; ++x) {
        double share = 0;
        for (int i = -7; i <= 7; ++i)
            if (x + i >= 16) share += weights[static_cast<size_t>(i + 7)];
        EXPECT_NEAR(filtered.pixels[3 * (size_t{16} * 32 + static_cast<size_t>(x))], 1 + 2 * share, 1e-5) << "column " << x;
    }
}

// A lamp shines into its own pixels only, and keeps them to itself.
TEST(Filters, LeaveEmissionAlone) {
    MadeFilms films(32);
    fill(films, [](uint32_t, uint32_t) { return vec3(0.25f); });
    for (uint32_t x = 14; x < 18; ++x) {
        films.set(x, 16, {vec3(50.25f), vec3(50.25f)}, 0);
        films.pixel(FILM_EMISSION, x, 16) = film_pixel(MadeFilms::samples, vec3(50), vec3(50));
        films.pixel(FILM_EMISSION_BEFORE, x, 16) = film_pixel(MadeFilms::samples / 2, vec3(50), vec3(50));
    }
    const Image expected = films.films[FILM_NOW].mean();
    for (const char* filter : {"bilateral", "a_trous", "nl_means"}) {
        const Image filtered = films.filter(filter).mean();
        for (size_t i = 0; i < filtered.pixels.size(); ++i)
            ASSERT_NEAR(filtered.pixels[i], expected.pixels[i], 1e-5 * expected.pixels[i]) << filter << ", number " << i;
    }
}

// What invalid samples left out is missing from their own pixel only.
TEST(Filters, DoNotSpreadInvalidPixels) {
    MadeFilms films(32);
    fill(films, [](uint32_t, uint32_t) { return vec3(1); });
    films.set(16, 16, {vec3(0.5f), vec3(0.5f)}, 0);
    films.pixel(FILM_NOW, 16, 16).invalid_count = MadeFilms::samples / 2;
    for (const char* filter : {"bilateral", "a_trous", "nl_means"}) {
        const FilmImage filtered = films.filter(filter);
        EXPECT_EQ(filtered.invalid_samples(), MadeFilms::samples / 2);
        const Image mean = filtered.mean();
        for (size_t i = 0; i < mean.pixels.size(); ++i) {
            if (i / 3 == 16 * 32 + 16) continue;
            ASSERT_NEAR(mean.pixels[i], 1, 1e-6) << filter << ", number " << i;
        }
    }
}

// Light that no diffuse albedo explains, of a mirror or behind glass, must not be divided by 0.
TEST(Filters, KeepBlackAlbedosFinite) {
    MadeFilms films(32);
    fill(films, [](uint32_t x, uint32_t) { return vec3(x % 2 == 0 ? 0.02f : 0.4f); });
    for (uint32_t y = 0; y < 32; ++y)
        for (uint32_t x = 0; x < 32; ++x)
            films.pixel(FILM_ALBEDO, x, y) = film_pixel(MadeFilms::samples, vec3(x % 2 == 0 ? 0.0f : 0.8f, 0.8f, 0.8f),
                                                        vec3(x % 2 == 0 ? 0.0f : 0.8f, 0.8f, 0.8f));
    for (const char* filter : {"bilateral", "a_trous", "nl_means"}) {
        const FilmImage picture = films.filter(filter);
        EXPECT_EQ(picture.invalid_samples(), 0) << filter;
        const Image filtered = picture.mean();
        for (size_t i = 0; i < filtered.pixels.size(); ++i) {
            const bool is_black = i % 3 == 0 && i / 3 % 2 == 0;  // red, in even columns
            ASSERT_GE(filtered.pixels[i], 0) << filter << ", number " << i;
            ASSERT_LE(filtered.pixels[i], is_black ? 0.05f : 0.45f) << filter << ", number " << i;
        }
    }
}

// A half that knew the other one could not be judged by it.
TEST(Filters, KeepHalvesIndependent) {
    MadeFilms films(32), others(32);
    fill(
        films, [](uint32_t, uint32_t) { return vec3(1); }, 0.1f);
    others = films;
    for (uint32_t y = 0; y < 32; ++y)
        for (uint32_t x = 0; x < 32; ++x) {
            const vec3 kept(means_of_halves(films.pixel(FILM_NOW, x, y))[0]);
            others.set(x, y, {kept, vec3(x % 3 == 0 ? 5.0f : 2.0f)}, 0.01f);
        }
    for (const char* filter : {"bilateral", "a_trous", "nl_means"}) {
        const FilmImage a = films.filter(filter), b = others.filter(filter);
        for (size_t i = 0; i < a.pixels.size(); ++i)
            ASSERT_NEAR(means_of_halves(a.pixels[i])[0].g, means_of_halves(b.pixels[i])[0].g, 1e-5) << filter << ", pixel " << i;
    }
}

// A picture of chapter 16: a reference's name, which ends with the path length, and the samples of a pixel.
struct DenoisedCase {
    std::string reference;
    uint32_t samples;
    double largest_gain;  // squared error of the filtered picture over that of the unfiltered one
};

class Denoising : public testing::TestWithParam<DenoisedCase> {
  protected:
    Denoising() : truth_(read_reference(project_folder() / "assets/references" / (GetParam().reference + ".exr"))) {}

    DenoisedScene scene(const std::string& filter) const {
        const std::string& name = GetParam().reference;
        const size_t end = name.rfind('_');
        return {load_shipped_scene(name.substr(0, end) + ".json"),
                {.width = truth_.mean.width,
                 .height = truth_.mean.height,
                 .samples = GetParam().samples,
                 .max_path_length = static_cast<uint32_t>(std::stoul(name.substr(end + 1))),
                 .roulette_start = 3,
                 .survival_weight = 0.5f,
                 .estimator = chapter_estimator(chapter_named("denoising"))},
                filter};
    }

    const Reference truth_;
};

// The squared error that the halves of a picture tell, relative as in compare(): for a single picture it may be negative, on
// average it is right.
double squared_error_of_halves(const Denoised& picture, const Image& truth) {
    double mean = 0, sum = 0;
    for (const float value : truth.pixels) mean += value / static_cast<double>(truth.pixels.size());
    for (size_t i = 0; i < truth.pixels.size(); ++i) {
        const auto channel = static_cast<int>(i % 3);
        const auto filtered = means_of_halves(picture.filtered.pixels[i / 3]), raw = means_of_halves(picture.raw.pixels[i / 3]);
        const auto square = [&](const glm::dvec3& a, const glm::dvec3& b) { return std::pow(a[channel] - b[channel], 2); };
        const double judged = 0.5 * square(filtered[0], raw[1]) + 0.5 * square(filtered[1], raw[0]);
        const double error = judged - 0.5 * square(raw[0], raw[1]) - 0.25 * square(filtered[0], filtered[1]);
        sum += error / (std::pow(truth.pixels[i], 2) + 0.01 * mean * mean);
    }
    return sum / static_cast<double>(truth.pixels.size());
}

TEST_P(Denoising, BeatsTheUnfilteredPictureAndKnowsItsError) {
    DenoisedScene pictures = scene("nl_means");
    double error = 0, unfiltered = 0, estimate = 0;
    for (uint32_t seed = 1; seed <= 12; ++seed) {
        const Denoised picture = pictures.render(seed << 16);
        const FilterError measured = measure_filter_error(picture.filtered, picture.raw, truth_);
        error += measured.error.rel_mse;
        unfiltered += measured.unfiltered;
        estimate += squared_error_of_halves(picture, truth_.mean);
    }
    record("filtered_over_unfiltered", "%.3f", error / unfiltered);
    record("estimated_over_measured", "%.3f", estimate / error);
    EXPECT_LE(error / unfiltered, GetParam().largest_gain);
    EXPECT_NEAR(estimate / error, 1, 0.2);
}

// The unfiltered picture is right on average, so the mean over seeds of what the filter changes is its bias: here that of tiles
// of 8 x 8 pixels, as a root mean square.
TEST_P(Denoising, BiasNeedsNoReference) {
    constexpr uint32_t tile = 8, seeds = 24;
    DenoisedScene pictures = scene("bilateral");
    const uvec2 tiles(truth_.mean.width / tile, truth_.mean.height / tile);
    std::vector<glm::dvec3> change(size_t{tiles.x} * tiles.y), error(change.size());
    for (uint32_t seed = 1; seed <= seeds; ++seed) {
        const Denoised picture = pictures.render(seed << 16);
        const Image filtered = picture.filtered.mean(), raw = picture.raw.mean();
        for (uint32_t y = 0; y < tiles.y * tile; ++y)
            for (uint32_t x = 0; x < tiles.x * tile; ++x)
                for (int channel = 0; channel < 3; ++channel) {
                    const size_t i = 3 * (size_t{y} * truth_.mean.width + x) + static_cast<size_t>(channel);
                    const size_t place = size_t{y / tile} * tiles.x + x / tile;
                    change[place][channel] += (filtered.pixels[i] - raw.pixels[i]) / double{tile * tile * seeds};
                    error[place][channel] += (filtered.pixels[i] - truth_.mean.pixels[i]) / double{tile * tile * seeds};
                }
    }
    const auto root_mean_square = [](const std::vector<glm::dvec3>& values) {
        double sum = 0;
        for (const glm::dvec3& value : values) sum += glm::dot(value, value) / 3 / static_cast<double>(values.size());
        return std::sqrt(sum);
    };
    record("bias_without_reference", "%.5f, with it %.5f", root_mean_square(change), root_mean_square(error));
    EXPECT_NEAR(root_mean_square(change), root_mean_square(error), 0.0005 + 0.1 * root_mean_square(error));
}

const auto denoised_case_name = [](const testing::TestParamInfo<DenoisedCase>& info) {
    return instance_name(info.param.reference + "_" + std::to_string(info.param.samples), Run::with_all);
};
INSTANTIATE_TEST_SUITE_P(Of, Denoising,
                         testing::Values(DenoisedCase{"cornell_box_6", 16, 0.14}, DenoisedCase{"textured_4", 16, 0.25},
                                         DenoisedCase{"smoke_8", 16, 0.3}, DenoisedCase{"cornell_box_6", 64, 0.3},
                                         DenoisedCase{"cornell_box_6", 256, 0.5}, DenoisedCase{"textured_4", 64, 0.5},
                                         DenoisedCase{"studio_4", 64, 0.5}),
                         denoised_case_name);

}  // namespace
}  // namespace lab
