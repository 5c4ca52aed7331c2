#include "scene/probe_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "parallel.h"
#include "scene/alias_table.h"
#include "scene/light_table.h"

namespace lab {
namespace {

constexpr size_t rows_at_once = 64;

// The mean over each texel of what linear filtering makes of a row of numbers: 1/8 of both neighbours.
double filtered(double before, double here, double after) { return (before + 6 * here + after) / 8; }

// The mean luminance of the filtered probe in each texel. The probe repeats from side to side and ends at the
// poles.
std::vector<float> filtered_luminances(const Image& probe) {
    const size_t width = probe.width, height = probe.height;
    std::vector<float> rows(width * height), texels(width * height);
    in_parallel(height, rows_at_once, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y) {
            const auto luminance = [&](size_t x) {
                const float* colour = &probe.pixels[3 * (y * width + x)];
                return get_luminance({colour[0], colour[1], colour[2]});
            };
            double before = luminance(width - 1), here = luminance(0);
            for (size_t x = 0; x < width; ++x) {
                const double after = luminance(x + 1 < width ? x + 1 : 0);
                rows[y * width + x] = static_cast<float>(filtered(before, here, after));
                before = here, here = after;
            }
        }
    });
    in_parallel(height, rows_at_once, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y)
            for (size_t x = 0; x < width; ++x)
                texels[y * width + x] =
                    static_cast<float>(filtered(rows[(y > 0 ? y - 1 : y) * width + x], rows[y * width + x],
                                                rows[(y + 1 < height ? y + 1 : y) * width + x]));
    });
    return texels;
}

// The texels [first, end) that a cell overlaps, in one of the two dimensions.
struct Range {
    size_t first, end;
};
Range overlapped(size_t cell, size_t cells, size_t texels) {
    return {cell * texels / cells, ((cell + 1) * texels + cells - 1) / cells};
}

}  // namespace

std::vector<ProbeCell> build_probe_table(const Image& probe, double probability) {
    const std::vector<float> texels = filtered_luminances(probe);
    const size_t columns = std::min(probe.width, MAX_PROBE_CELL_COLUMNS),
                 rows = std::min(probe.height, MAX_PROBE_CELL_ROWS);
    std::vector<double> weights(columns * rows), solid_angles(rows);
    const auto weigh_row = [&](size_t row) {
        // cos a - cos b, which would cancel close to the poles.
        const double angle = std::numbers::pi / static_cast<double>(rows);
        solid_angles[row] = 2 * std::numbers::pi / static_cast<double>(columns) * 2 * std::sin(0.5 * angle) *
                            std::sin((static_cast<double>(row) + 0.5) * angle);
        const Range y = overlapped(row, rows, probe.height);
        for (size_t column = 0; column < columns; ++column) {
            const Range x = overlapped(column, columns, probe.width);
            double sum = 0;
            for (size_t i = y.first; i < y.end; ++i)
                for (size_t k = x.first; k < x.end; ++k) sum += texels[i * probe.width + k];
            weights[row * columns + column] =
                solid_angles[row] * sum / static_cast<double>((y.end - y.first) * (x.end - x.first));
        }
    };
    in_parallel(rows, rows_at_once, [&](size_t begin, size_t end) {
        for (size_t row = begin; row < end; ++row) weigh_row(row);
    });
    if (std::all_of(weights.begin(), weights.end(), [](double weight) { return weight == 0; }))
        for (size_t i = 0; i < weights.size(); ++i) weights[i] = solid_angles[i / columns];
    const AliasTable table = build_alias_table(weights);
    std::vector<ProbeCell> cells(weights.size());
    for (size_t i = 0; i < cells.size(); ++i)
        cells[i] = {table.entries[i].threshold, table.entries[i].alias,
                    static_cast<float>(probability * table.probabilities[i] / solid_angles[i / columns])};
    return cells;
}

}  // namespace lab
