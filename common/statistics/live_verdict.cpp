#include "statistics/live_verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "error.h"

namespace lab {
namespace {

constexpr uint32_t tile = 8;  // pixels of the reference
constexpr uint32_t first_test = 16;
constexpr double power = 0.99;
// Paths after which a region's mean is normally distributed even if only one in 1000 meets a light.
constexpr double reliable_paths = 1 << 17;
// Differences below this fraction of the image's mean count as noise.
constexpr double tile_floor = 5e-4;
// Allowance for a renderer that rounds differently.
constexpr double renderer_rounding = 1e-5;

double square(double x) { return x * x; }

}  // namespace

// Rounds to the first digit of the interval.
std::string interval_text(const Difference& difference) {
    const double half_width = 1.96 * difference.standard_error;
    const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(std::max(100 * half_width, 1e-9)))), 0, 3);
    char text[64];
    std::snprintf(text, sizeof text, "%+.*f %% ± %.*f %%", digits, 100 * difference.value, digits, 100 * half_width);
    return text;
}

LiveVerdict::LiveVerdict(Reference reference, glm::uvec2 image_size, double false_alarms)
    : reference_(std::move(reference)), false_alarms_(false_alarms) {
    const glm::uvec2 size(reference_.mean.width, reference_.mean.height);
    if (image_size % size != glm::uvec2(0) || image_size.x / size.x != image_size.y / size.y)
        throw UserError("the reference has " + size_text(size) + " pixels, the image " + size_text(image_size) +
                        ": it must be a whole number of times larger");
    scale_ = image_size.x / size.x;
    tiles_ = (size + tile - 1u) / tile;
    reference_samples_ = std::strtod(reference_.attributes["samples"].c_str(), nullptr);  // 0 if unknown
    const double paths_of_sample = square(scale_) * reference_.mean.width * reference_.mean.height;
    next_samples_ = first_test;
    while (next_samples_ * paths_of_sample < reliable_paths) next_samples_ *= 2;
}

void LiveVerdict::add(const FilmImage& film) {
    const Image& mean = reference_.mean;
    differences_.assign(size_t{mean.width} * mean.height, glm::dvec3(0));
    const double part = 1 / (square(scale_) * next_samples_);
    for (uint32_t y = 0; y < film.height; ++y)
        for (uint32_t x = 0; x < film.width; ++x)
            differences_[size_t{y / scale_} * mean.width + x / scale_] += part * sum_of(film.pixels[size_t{y} * film.width + x]);
    for (size_t i = 0; i < differences_.size(); ++i)
        for (int channel = 0; channel < 3; ++channel) differences_[i][channel] -= double{mean.pixels[3 * i + channel]};
    samples_ = next_samples_;
    next_samples_ *= 2;
    test();
}

Reference::Part LiveVerdict::expected(const Region& region, int channel) const {
    const glm::uvec2 corner = region.first * tile;
    const glm::uvec2 end = glm::min(region.end * tile, glm::uvec2(reference_.mean.width, reference_.mean.height));
    return reference_.part(channel, corner, end - corner);
}

// Difference of a channel's mean over a region, in radiance.
Difference LiveVerdict::difference(const Region& region, int channel) const {
    const glm::uvec2 corner = region.first * tile;
    const glm::uvec2 end = glm::min(region.end * tile, glm::uvec2(reference_.mean.width, reference_.mean.height));
    std::vector<double> pixels;
    for (uint32_t y = corner.y; y < end.y; ++y)
        for (uint32_t x = corner.x; x < end.x; ++x)
            pixels.push_back(differences_[size_t{y} * reference_.mean.width + x][channel]);
    // A single pixel has no variance.
    if (pixels.size() == 1) return {.standard_error = INFINITY, .degrees_of_freedom = 1};
    Difference difference = difference_from(pixels, 0);
    double variance = square(difference.standard_error);
    // Too few chance hits of a light make both mean and spread too small. The variance of rare events is proportional to their
    // mean: scale it to the reference's.
    const Reference::Part reference = expected(region, channel);
    const double mean = reference.mean + difference.value;
    if (mean > 0) variance *= std::max(reference.mean / mean, 1.0);
    // Events that have not occurred yet do not show in the spread, but in the reference's variance.
    const double reference_samples = reference_samples_ / square(scale_);
    variance = std::max(variance, reference.variance * reference_samples / samples_);
    difference.standard_error = std::sqrt(variance + square(renderer_rounding * reference.mean));
    return difference;
}

// Edge, in tiles, of the smallest square regions with enough paths; 0 if not even the image has enough.
uint32_t LiveVerdict::finest_reliable_edge() const {
    const double paths_of_tile = square(tile * scale_) * samples_;
    for (uint32_t edge = 1; edge < std::max(tiles_.x, tiles_.y); edge *= 2)
        if (square(edge) * paths_of_tile >= reliable_paths) return edge;
    return 0;
}

void LiveVerdict::test() {
    const double level = 0.5 * false_alarms_ / ((tests_ + 1.0) * (tests_ + 2.0));
    ++tests_;
    Verdict verdict{.samples = samples_,
                    .is_biased = verdict_ && verdict_->is_biased,
                    .differences = {},
                    .map = {tiles_.x, tiles_.y, std::vector<double>(size_t{tiles_.x} * tiles_.y)},
                    .map_differences = {},
                    .map_tile_size = tile * scale_};
    std::array<double, 3> scales;
    for (int channel = 0; channel < 3; ++channel) {
        const double mean = expected({{0, 0}, tiles_}, channel).mean;
        scales[channel] = mean > 0 ? mean : 1;
        const Difference of_image = difference({{0, 0}, tiles_}, channel).relative_to(scales[channel]);
        verdict.differences[channel] = of_image;
        verdict.smallest_detectable[channel] = of_image.smallest_detectable(sidak(level, 3), power);
        verdict.is_biased |= of_image.p_value() < sidak(level, 3);
    }
    // The channel of a region that is farthest off, relative to the reference's mean there.
    const auto worst = [&](uint32_t x, uint32_t y, uint32_t edge) {
        Difference farthest;
        for (int channel = 0; channel < 3; ++channel) {
            const Region region{{x, y}, glm::min(glm::uvec2(x, y) + edge, tiles_)};
            const double floor = tile_floor * scales[channel];
            Difference d = difference(region, channel);
            d.standard_error = std::hypot(d.standard_error, floor);
            d = d.relative_to(std::max(expected(region, channel).mean, floor));
            if (channel == 0 || std::abs(d.z()) > std::abs(farthest.z())) farthest = d;
        }
        return farthest;
    };
    for (uint32_t y = 0; y < tiles_.y; ++y)
        for (uint32_t x = 0; x < tiles_.x; ++x) {
            verdict.map_differences.push_back(worst(x, y, 1));
            verdict.map.values[size_t{y} * tiles_.x + x] = verdict.map_differences.back().z();
        }
    if (const uint32_t edge = finest_reliable_edge(); edge > 0) {
        verdict.tile_size = edge * tile * scale_;
        const glm::uvec2 regions = (tiles_ + edge - 1u) / edge;
        verdict.tiles = regions.x * regions.y;
        for (uint32_t y = 0; y < tiles_.y; y += edge)
            for (uint32_t x = 0; x < tiles_.x; x += edge) {
                const Difference d = worst(x, y, edge);
                if (!(d.p_value() < sidak(level, size_t{3} * verdict.tiles))) continue;
                ++(d.value > 0 ? verdict.bright_tiles : verdict.dark_tiles);
                verdict.is_biased = true;
            }
    }
    verdict_ = std::move(verdict);
}

std::array<uint8_t, 3> z_colour(double z) { return signed_colour(z / 5); }

std::array<uint8_t, 3> signed_colour(double x) {
    x = std::clamp(x, -1.0, 1.0);
    const auto byte = [](double part) { return static_cast<uint8_t>(std::lround(255 * part)); };
    return {byte(1 + std::min(x, 0.0)), byte(1 - std::abs(x)), byte(1 - std::max(x, 0.0))};
}

std::string to_text(const Verdict& verdict) {
    if (!verdict.is_biased) {
        const double largest = *std::max_element(verdict.smallest_detectable.begin(), verdict.smallest_detectable.end());
        char text[96];
        std::snprintf(text, sizeof text, "agrees with the reference: a bias above %.2g %% would show by now", 100 * largest);
        return text;
    }
    const auto& differences = verdict.differences;
    std::string text = "biased: red " + interval_text(differences[0]) + ", green " + interval_text(differences[1]) + ", blue " +
                       interval_text(differences[2]);
    const uint32_t off = verdict.bright_tiles + verdict.dark_tiles;
    if (off > 0)
        text += "; of " + std::to_string(verdict.tiles) + " tiles of " + std::to_string(verdict.tile_size) + " pixels, " +
                std::to_string(verdict.bright_tiles) + " are too bright and " + std::to_string(verdict.dark_tiles) + " too dark";
    return text;
}

std::string LiveVerdict::text() const {
    if (verdict_) return to_text(*verdict_);
    return "no verdict before " + std::to_string(next_samples_) + " samples a pixel";
}

}  // namespace lab
