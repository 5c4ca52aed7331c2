#include "support/agreement.h"

#include "support/expect_statistics.h"
#include "support/failure_images.h"

namespace lab {

std::vector<double> expect_agreement(const std::string& what, const Batches& image, const Batches& oracle,
                                     const AgreementLimits& limits) {
    constexpr uint32_t tile = 8;
    std::vector<Difference> of_image, of_tiles;
    std::vector<double> p_values;
    ZMap map{image.width / tile, image.height / tile, {}};
    for (int channel = 0; channel < 3; ++channel) {
        const std::vector<double> expected = oracle.means(channel);
        const double mean = estimate_mean(expected).mean;
        of_image.push_back(difference_of(image.means(channel), expected).relative_to(mean));
        for (uint32_t y = 0; y < image.height; y += tile)
            for (uint32_t x = 0; x < image.width; x += tile) {
                of_tiles.push_back(
                    difference_of(image.means(channel, {x, y}, uvec2(tile)), oracle.means(channel, {x, y}, uvec2(tile)))
                        .relative_to(mean));
                // The other channels follow the same paths and would not be independent.
                if (channel != 1) continue;
                const Difference& difference = of_tiles.back();
                p_values.push_back(difference.p_value());
                map.values.push_back(difference.standard_error > 0 ? difference.value / difference.standard_error : 0);
            }
    }
    const int failed_before = failed_expectations();
    expect_no_difference(what + ", image", of_image, limits.image);
    expect_no_difference(what + ", tiles", of_tiles, limits.tile);
    if (failed_expectations() > failed_before) write_failure(what, image.mean_image(), oracle.mean_image(), map);
    return p_values;
}

}  // namespace lab
