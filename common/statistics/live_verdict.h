// Tells while an image renders whether it will be that of the reference.
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

// How many standard errors each tile is off; positive where it is too bright. Row by row, one channel.
struct ZMap {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<double> values;
};

// What such a number is shown as: red where it is too bright, blue where too dark, full colour at 5 standard
// errors.
std::array<uint8_t, 3> z_colour(double z);
// The same from -1 to 1.
std::array<uint8_t, 3> signed_colour(double x);

struct Verdict {
    uint32_t samples = 0;  // a pixel, when it was found
    bool is_biased = false;
    // Of each channel's mean over the image, as part of the reference's; and the smallest bias that would
    // have been found by then with probability 0.99.
    std::array<Difference, 3> differences;
    std::array<double, 3> smallest_detectable{};
    uint32_t tile_size = 0;  // of the tiles that were tested, in pixels of the image; 0: none yet
    uint32_t tiles = 0, bright_tiles = 0, dark_tiles = 0;  // all, significantly too bright, too dark
    ZMap map;  // tiles of 8 x 8 pixels of the reference, of each the channel that is farthest off
    std::vector<Difference> map_differences;  // of these tiles and channels, as part of the reference's mean
    uint32_t map_tile_size = 0;               // of these, in pixels of the image
};

// "-14 % ± 1 %" of a difference as part of something: the interval holds the bias with probability 0.95.
std::string interval_text(const Difference& difference);

// "agrees with the reference: …" or "biased: …", in one line.
std::string to_text(const Verdict& verdict);

// Pixels are independent of each other, also where the samples of a pixel are not. So the spread of their
// differences from the reference tells how exact the mean difference is.
//
// Looking again and again raises the chance to see a difference where there is none. So the image is tested
// only at 16, 32, 64, … samples, and test number j spends 1/((j + 1)(j + 2)) of the probability of a false
// alarm: all of them together spend it once, however long one looks. Half of it is for the channels' means,
// half for tiles.
class LiveVerdict {
  public:
    // Probability that a render without bias is called biased at any time.
    static constexpr double default_false_alarms = 1e-3;

    // The image may be a whole number of times larger than the reference. Throws UserError if it is not.
    LiveVerdict(Reference reference, glm::uvec2 image_size, double false_alarms = default_false_alarms);

    // Samples a pixel at which add() wants the film: a power of two.
    uint32_t next_samples() const { return next_samples_; }
    // The film when all pixels have next_samples() samples.
    void add(const FilmImage& film);
    // The latest; none before 16 samples, of a small image more. Once it is biased it stays so.
    const std::optional<Verdict>& verdict() const { return verdict_; }
    // What there is to say, in one line.
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
    // From the reference, of each of its pixels.
    std::vector<glm::dvec3> differences_;
    uint32_t samples_ = 0;  // a pixel of the image
    uint32_t next_samples_;
    uint32_t tests_ = 0;
    std::optional<Verdict> verdict_;
};

}  // namespace lab
