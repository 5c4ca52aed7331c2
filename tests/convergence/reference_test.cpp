// The chapters against images by another renderer: Mitsuba 3, see tools/references.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "files/file.h"
#include "files/project_folder.h"
#include "statistics/error_metrics.h"
#include "support/expect_statistics.h"
#include "support/failure_images.h"
#include "support/gpu_test.h"
#include "support/render.h"

namespace lab {
namespace {

constexpr uint32_t reference_batches = 64;
constexpr uint32_t tile = 8;
// In tiles that hardly any light reaches, batches without a hit have no spread. Differences there that are a small fraction of
// the image's mean count as noise.
constexpr double tile_floor = 5e-4;

// What "tests" in the chapters' chapter.json ask for. Chapters that find lights by bounces are held to 1 % of the image's mean,
// the others to 0.3 %; less strictly in the slowest cases: glass with a small lamp, whose caustics bounces find by chance, small
// lamps out of focus, and the studio. Only those that are cheap, or alone find a mistake of the catalogue, run every time.
const std::vector<ReferenceCase> all_references = reference_cases();

// A batch's estimate over a rectangle of pixels, and the reference's mean there.
struct Comparison {
    const Batches& batches;
    const Reference& reference;

    // Difference of the means over a rectangle, relative to `scale`. Includes the variance of the reference.
    Difference difference(int channel, uvec2 corner, uvec2 size, double scale) const {
        const Reference::Part expected = reference.part(static_cast<size_t>(channel), corner, size);
        Difference difference = difference_from(batches.means(channel, corner, size), expected.mean);
        // Pure emission has no variance, but the two programs round it differently.
        const double rounding = 1e-5 * std::abs(expected.mean);
        difference.standard_error = std::hypot(difference.standard_error, std::sqrt(expected.variance), rounding);
        return difference.relative_to(scale);
    }
};

// Mean excess kurtosis of the tiles' batch means: about 0 if batches are long enough for their spread to estimate the error of
// the mean.
double excess_kurtosis(const Batches& batches) {
    double sum = 0;
    size_t count = 0;
    for (uint32_t y = 0; y < batches.height; y += tile)
        for (uint32_t x = 0; x < batches.width; x += tile) {
            const auto numbers = batches.means(1, {x, y}, uvec2(tile));
            const double mean = estimate_mean(numbers).mean;
            double second = 0, fourth = 0;
            for (const double number : numbers) {
                second += std::pow(number - mean, 2);
                fourth += std::pow(number - mean, 4);
            }
            if (second == 0) continue;
            sum += static_cast<double>(numbers.size()) * fourth / (second * second) - 3;
            ++count;
        }
    return count ? sum / static_cast<double>(count) : 0;
}

// Signs of neighbouring tiles are independent if there is only noise; a bias is coherent. Returns the p-value of the number of
// neighbours with equal signs.
double sign_map_p_value(const ZMap& map) {
    double equal = 0, pairs = 0;
    for (uint32_t y = 0; y < map.height; ++y)
        for (uint32_t x = 0; x < map.width; ++x) {
            const double z = map.values[size_t{y} * map.width + x];
            const auto compare = [&](double neighbour) {
                if (z == 0 || neighbour == 0) return;  // black tiles
                ++pairs;
                equal += (z > 0) == (neighbour > 0);
            };
            if (x > 0) compare(map.values[size_t{y} * map.width + x - 1]);
            if (y > 0) compare(map.values[size_t{y - 1} * map.width + x]);
        }
    return pairs > 0 ? normal_p_value((equal - 0.5 * pairs) / std::sqrt(0.25 * pairs)) : 1;
}

std::string case_name(const ReferenceCase& c) {
    return instance_name(c.reference + "_chapter_" + c.chapter, c.runs_with_all ? Run::with_all : Run::always);
}

// A chapter's first reference is rendered by `compute`, which shares nothing with `native` but the shaders; the others with what
// users get.
Backend backend_for(const ReferenceCase& c) {
    const auto first = std::ranges::find(all_references, c.chapter, &ReferenceCase::chapter);
    return &*first == &c ? compute_backend : fastest_backend();
}

class ReferenceImage : public testing::TestWithParam<size_t> {};
INSTANTIATE_TEST_SUITE_P(, ReferenceImage, testing::Range(size_t{0}, all_references.size()),
                         [](const auto& instance) { return case_name(all_references[instance.param]); });

TEST_P(ReferenceImage, IsWhatTheChapterConvergesTo) {
    const ReferenceCase& c = all_references[GetParam()];
    const auto file = project_folder() / "assets" / "references" / (c.reference + ".exr");
    const Reference reference = read_reference(file);
    const auto& attributes = reference.attributes;
    const Scene scene = load_shipped_scene(attributes.at("scene"));
    ASSERT_EQ(attributes.at("scene_hash"), hexadecimal(scene.hash))
        << file << " is stale: its scene has changed; run ./lab reference --all";

    RenderSettings settings{.width = reference.mean.width, .height = reference.mean.height, .samples = c.samples};
    settings.max_path_length = static_cast<uint32_t>(std::stoul(attributes.at("max_path_length")));
    // Different for each case: chapters may follow the same paths if their seeds are equal.
    settings.seed = 1000 + static_cast<uint32_t>(&c - all_references.data());
    settings.roulette_start = 2;
    settings.splitting_factor = 2;
    settings.estimator = chapter_estimator(c.chapter);
    settings.backend = backend_for(c);
    const Batches batches = render_batches(scene, settings, reference_batches);

    const Comparison comparison{batches, reference};
    const uvec2 size(batches.width, batches.height);
    std::vector<Difference> of_image, of_tiles;
    std::vector<double> p_values;
    ZMap map{size.x / tile, size.y / tile, {}};
    for (int channel = 0; channel < 3; ++channel) {
        const double mean = reference.part(static_cast<size_t>(channel), {0, 0}, size).mean;
        of_image.push_back(comparison.difference(channel, {0, 0}, size, mean));
        for (uint32_t y = 0; y < size.y; y += tile)
            for (uint32_t x = 0; x < size.x; x += tile) {
                const Difference difference = comparison.difference(channel, {x, y}, uvec2(tile), mean);
                of_tiles.push_back(difference);
                of_tiles.back().standard_error = std::hypot(difference.standard_error, tile_floor);
                if (channel != 1) continue;
                // Tiles that see only a light or the sky are noise-free, so their p-values are not uniform.
                const MeanEstimate estimate = estimate_mean(batches.means(channel, {x, y}, uvec2(tile)));
                const bool is_noisy = estimate.standard_error > 1e-5 * estimate.mean;
                map.values.push_back(is_noisy ? difference.value / difference.standard_error : 0);
                if (is_noisy) p_values.push_back(difference.p_value());
            }
    }
    expect_no_difference("image", of_image, c.largest_bias);
    expect_no_difference("tiles", of_tiles, c.largest_tile_bias);
    expect_uniform("p-values of the tiles", p_values, 0.3);
    const double sign_p_value = sign_map_p_value(map), kurtosis = excess_kurtosis(batches);
    std::printf("  signs of neighbouring tiles: p = %.2g; excess kurtosis of batches %.2f\n", sign_p_value, kurtosis);
    EXPECT_GT(sign_p_value, significance) << "neighbouring tiles are off to the same side";
    if (!c.has_heavy_tail) {
        EXPECT_LT(kurtosis, 2) << "the batches' spread does not tell the error of their mean";
    }
    if (HasFailure()) write_failure("", batches.mean_image(), reference.mean, map);
}

}  // namespace
}  // namespace lab
