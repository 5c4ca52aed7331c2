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

// By how many standard errors each tile is off, row by row; positive if too bright.
struct ZMap {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<double> values;
};

// Colour for a number of standard errors: red for too bright, blue for too dark, saturated at 5.
std::array<uint8_t, 3> z_colour(double z);
// The same for values in [-1,1].
std::array<uint8_t, 3> signed_colour(double x);

struct Verdict {
    uint32_t samples = 0;  // per pixel, when the verdict was reached
    bool is_biased = false;
    // Each channel's mean over the image minus the reference's, relative to the latter; and the smallest bias that the test would
    // have found with probability 0.99.
    std::array<Difference, 3> differences;
    std::array<double, 3> smallest_detectable{};
    uint32_t tile_size = 0;                                // of the tested tiles, in pixels of the image; 0: none yet
    uint32_t tiles = 0, bright_tiles = 0, dark_tiles = 0;  // tested, significantly too bright, too dark
    ZMap map;                                              // 8 x 8 pixels of the reference each; the channel that is farthest off
    std::vector<Difference> map_differences;               // for the same, relative to the reference's mean
    uint32_t map_tile_size = 0;                            // in pixels of the image
};

// A relative difference as "-14 % ± 1 %", with its 95 % confidence interval.
std::string interval_text(const Difference& difference);

// "agrees with the reference: …" or "biased: …", in one line.
std::string to_text(const Verdict& verdict);

// Pixels are independent of each other even if the samples within a pixel are not, so the spread of their differences from the
// reference gives the standard error of the mean difference. Repeated tests raise the risk of a false alarm. So the image is
// tested only at 16, 32, 64, … samples, and test j spends 1/((j + 1)(j + 2)) of the total probability, half of it on the
// channels' means and half on tiles.
class LiveVerdict {
  public:
    // Probability that an unbiased render is ever called biased.
    static constexpr double default_false_alarms = 1e-3;

    // Throws UserError unless the image is an integer factor larger than the reference.
    LiveVerdict(Reference reference, glm::uvec2 image_size, double false_alarms = default_false_alarms);

    // Samples per pixel at which to call add() next: a power of two.
    uint32_t next_samples() const { return next_samples_; }
    // Tests the film, whose pixels must have next_samples() samples.
    void add(const FilmImage& film);
    // The latest verdict; none before 16 samples, or later for small images. "Biased" is final.
    const std::optional<Verdict>& verdict() const { return verdict_; }
    // One line for the user.
    std::string text() const;

  private:
    // Tiles that are tested as one.
    struct Region {
        glm::uvec2 first, end;  // in tiles
    };
    Reference::Part expected(const Region& region, int channel) const;
    Difference difference(const Region& region, int channel) const;
    uint32_t finest_reliable_edge() const;
    void test();

    Reference reference_;
    double reference_samples_;  // per pixel
    double false_alarms_;
    uint32_t scale_;  // width of a reference pixel in image pixels
    glm::uvec2 tiles_;
    // Image minus reference, per pixel of the reference.
    std::vector<glm::dvec3> differences_;
    uint32_t samples_ = 0;  // per pixel of the image
    uint32_t next_samples_;
    uint32_t tests_ = 0;
    std::optional<Verdict> verdict_;
};

}  // namespace lab
