// The table of cells from which light samples on a probe are drawn.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "scene/light_table.h"

namespace lab {
namespace {

using std::numbers::pi;

double solid_angle(uint32_t row, uint32_t columns, uint32_t rows) {
    return 2 * pi / columns * (std::cos(pi * row / rows) - std::cos(pi * (row + 1) / rows));
}

Image make_probe(uint32_t width, uint32_t height, float radiance) {
    return {width, height, std::vector<float>(size_t{3} * width * height, radiance)};
}

void set_texel(Image& probe, uint32_t x, uint32_t y, float radiance) {
    for (size_t channel = 0; channel < 3; ++channel) probe.pixels[3 * (size_t{y} * probe.width + x) + channel] = radiance;
}

// The integral of the density over all directions, after checking the table's size.
double total(const std::vector<ProbeCell>& cells, uint32_t columns, uint32_t rows) {
    EXPECT_EQ(cells.size(), size_t{columns} * rows);
    double sum = 0;
    for (size_t i = 0; i < cells.size(); ++i)
        sum += double{cells[i].density} * solid_angle(static_cast<uint32_t>(i / columns), columns, rows);
    return sum;
}

TEST(ProbeTable, DensitiesIntegrateToTheProbabilityOfTheProbe) {
    std::mt19937 random(3);
    for (const auto& [width, height] : {std::pair{1u, 1u}, {2u, 1u}, {7u, 5u}, {64u, 32u}, {300u, 700u}}) {
        Image probe = make_probe(width, height, 0);
        for (float& number : probe.pixels) number = std::exponential_distribution<float>()(random);
        EXPECT_NEAR(total(build_probe_table(probe), width, height), 1, 1e-6);
        EXPECT_NEAR(total(build_probe_table(probe, 0.25), width, height), 0.25, 1e-6);
    }
}

TEST(ProbeTable, FollowsTheMeanOfTheFilteredRadiance) {
    // One texel spreads into its neighbours, across the seam, and at a pole into itself.
    Image probe = make_probe(16, 8, 0);
    set_texel(probe, 0, 0, 80);
    const auto cells = build_probe_table(probe);
    const auto weight = [&](uint32_t x, uint32_t y) { return double{cells[y * 16 + x].density}; };
    for (uint32_t y = 0; y < 8; ++y)
        for (uint32_t x = 0; x < 16; ++x) {
            const double across = x == 0 ? 6 : x == 1 || x == 15 ? 1 : 0, down = y == 0 ? 7 : y == 1 ? 1 : 0;
            EXPECT_NEAR(weight(x, y) / weight(0, 0), across * down / 42, 1e-6) << x << ", " << y;
        }
}

TEST(ProbeTable, OfABlackProbeIsUniform) {
    for (const ProbeCell& cell : build_probe_table(make_probe(32, 16, 0))) EXPECT_NEAR(cell.density, 1 / (4 * pi), 1e-6);
    for (const ProbeCell& cell : build_probe_table(make_probe(32, 16, 3))) EXPECT_NEAR(cell.density, 1 / (4 * pi), 1e-6);
}

TEST(ProbeTable, HasLargerCellsWhereThereAreVeryManyTexels) {
    // A cell does not cover a whole number of texels, and every texel that it overlaps counts.
    Image probe = make_probe(MAX_PROBE_CELL_COLUMNS + 1000, 3, 0);
    set_texel(probe, 1500, 1, 1);
    const auto cells = build_probe_table(probe);
    EXPECT_NEAR(total(cells, MAX_PROBE_CELL_COLUMNS, 3), 1, 1e-6);
    for (uint32_t texel : {1499u, 1500u, 1501u})
        for (const double part : {0.001, 0.999}) {
            const auto cell = static_cast<uint32_t>((texel + part) / probe.width * MAX_PROBE_CELL_COLUMNS);
            EXPECT_GT(cells[MAX_PROBE_CELL_COLUMNS + cell].density, 0) << texel;
        }
}

}  // namespace
}  // namespace lab
