// Tests while an image renders whether it converges to the reference.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "film/film_image.h"
#include "statistics/error_metrics.h"
#include "statistics/statistics.h"

namespace lab {

// How many standard errors each tile is off, row by row; positive where it is too bright.
struct ZMap {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<double> values;
};

// The colour of such a number: red for too bright, blue for too dark, saturated at 5 standard errors.
std::array<uint8_t, 3> z_colour(double z);
// The same for numbers in [-1,1].
std::array<uint8_t, 3> signed_colour(double x);

struct Verdict {
    uint32_t samples = 0;  // a pixel, when it was found
    bool is_biased = false;
    // Of each channel's mean over the image, relative to the reference's mean; and the smallest bias that the test would have
    // found with probability 0.99.
    std::array<Difference, 3> differences;
    std::array<double, 3> smallest_detectable{};
    uint32_t tile_size = 0;                                // of the tested tiles, in pixels of the image; 0: none yet
    uint32_t tiles = 0, bright_tiles = 0, dark_tiles = 0;  // tested, significantly too bright, too dark
    ZMap map;                                              // 8 x 8 pixels of the reference each; the channel that is farthest off
    std::vector<Difference> map_differences;               // of the same, relative to the reference's mean
    uint32_t map_tile_size = 0;                            // in pixels of the image
};

// A relative difference as "-14 % ± 1 %", with its 95 % confidence interval.
std::string interval_text(const Difference& difference);

// "agrees with the reference: …" or "biased: …", in one line.
std::string to_text(const Verdict& verdict);

// Pixels are independent of each other even where the samples of a pixel are not, so the spread of their differences from the
// reference gives the standard error of the mean difference. Repeated tests raise the chance of a false alarm. So the image is
// tested only at 16, 32, 64, … samples, and test j spends 1/((j + 1)(j + 2)) of the total probability, half of it on the
// channels' means and half on tiles.
class LiveVerdict {
  public:
    // Probability that an unbiased render is ever called biased.
    static constexpr double default_false_alarms = 1e-3;

    // Throws UserError unless the image is a whole number of times larger than the reference.
    LiveVerdict(Reference reference, glm::uvec2 image_size, double false_alarms = default_false_alarms);

    // Samples per pixel at which to call add(): a power of two.
    uint32_t next_samples() const { return next_samples_; }
    // Tests the film, whose pixels have next_samples() samples.
    void add(const FilmImage& film);
    // The latest; none before 16 samples, later for small images. Biased is final.
    const std::optional<Verdict>& verdict() const { return verdict_; }
    // One line for users.
    std::string text() const;

  private:
    // Tiles that are tested together.
    struct Region {
        glm::uvec2 first, end;  // in tiles
    };
    Reference::Part expected(const Region& region, int channel) const;
    Difference difference(const Region& region, int channel) const;
    uint32_t finest_reliable_edge() const;
    void test();

    Reference reference_;
    double reference_samples_;  // a pixel
    double false_alarms_;
    uint32_t scale_;  // image pixels in a row of a reference pixel
    glm::uvec2 tiles_;
    // Image minus reference, per pixel of the reference.
    std::vector<glm::dvec3> differences_;
    uint32_t samples_ = 0;  // a pixel of the image
    uint32_t next_samples_;
    uint32_t tests_ = 0;
    std::optional<Verdict> verdict_;
};

}  // namespace lab
