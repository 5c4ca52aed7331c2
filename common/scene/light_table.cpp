#include "scene/light_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "error.h"
#include "parallel.h"
#include "scene/coincident_lights.h"

namespace lab {

double get_luminance(const vec3& colour) { return 0.2126 * colour.r + 0.7152 * colour.g + 0.0722 * colour.b; }

double light_area(const Scene& scene, uint32_t instance, uint32_t triangle) {
    const double area = world_area(scene, instance, triangle);
    return area > 0 ? std::max(area, 1e-37) : 0;
}

namespace {

constexpr uint64_t max_light_triangles = 1u << 24;

// Rays find only one of several coincident emissive triangles of different instances: keeps the first.
void keep_one_in_each_place(const Scene& scene, std::vector<LightTriangle>& lights) {
    std::vector<std::pair<Place, size_t>> places;
    places.reserve(lights.size());
    for (const LightTriangle& light : lights)
        places.emplace_back(get_place(scene, scene.instances[light.instance], light.triangle), places.size());
    std::sort(places.begin(), places.end());
    std::vector<bool> is_first(lights.size(), true);
    for (size_t i = 1; i < places.size(); ++i) is_first[places[i].second] = places[i].first != places[i - 1].first;
    size_t kept = 0;
    for (size_t i = 0; i < lights.size(); ++i)
        if (is_first[i]) lights[kept++] = lights[i];
    lights.resize(kept);
}

}  // namespace

LightTable build_light_table(const Scene& scene, double probability) {
    const auto luminance_of = [&](uint32_t triangle) { return get_luminance(scene.material_of(triangle).emission); };
    std::vector<std::vector<uint32_t>> emissive_triangles;  // per mesh, which may have many instances
    for (const Mesh& mesh : scene.meshes) {
        auto& triangles = emissive_triangles.emplace_back();
        std::ranges::copy_if(mesh.triangles(), std::back_inserter(triangles),
                             [&](uint32_t triangle) { return luminance_of(triangle) > 0; });
    }
    uint64_t count = 0;
    for (const uint32_t mesh : scene.instance_meshes) count += emissive_triangles[mesh].size();
    if (count > max_light_triangles)
        throw UserError(scene.file.string() + ": its instances have " + std::to_string(count) +
                        " emissive triangles together, more than 2^24: remove instances or use simpler lights");

    LightTable table{.triangles = {}, .materials = scene.materials};
    std::vector<LightTriangle>& lights = table.triangles;
    lights.reserve(count);
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance)
        for (const uint32_t triangle : emissive_triangles[scene.instance_meshes[instance]])
            lights.push_back({instance, triangle, 0, 0, 0});
    keep_one_in_each_place(scene, lights);
    if (lights.empty()) return table;
    std::vector<double> areas, weights;
    for (const LightTriangle& light : lights) {
        areas.push_back(light_area(scene, light.instance, light.triangle));
        weights.push_back(areas.back() * luminance_of(light.triangle));
    }
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (Material& material : table.materials)
        material.light_density = static_cast<float>(probability * get_luminance(material.emission) / sum);
    const AliasTable alias_table = build_alias_table(weights);
    for (size_t i = 0; i < lights.size(); ++i) {
        lights[i].threshold = alias_table.entries[i].threshold;
        lights[i].alias = alias_table.entries[i].alias;
        lights[i].inverse_density = static_cast<float>(areas[i] / (probability * alias_table.probabilities[i]));
    }
    return table;
}

namespace {

constexpr double word_count = 4294967296.0;  // 2^32

}  // namespace

AliasTable build_alias_table(std::span<const double> weights) {
    const size_t count = weights.size();
    const auto heaviest = std::ranges::max_element(weights);
    const double largest = *heaviest;
    double sum = 0;
    for (const double weight : weights) sum += weight / largest;
    // The share of each item, in units of an entry's probability.
    std::vector<double> share(count);
    std::vector<uint32_t> small, large;
    for (uint32_t i = 0; i < count; ++i) {
        share[i] = weights[i] / largest / sum * static_cast<double>(count);
        (share[i] < 1 ? small : large).push_back(i);
    }

    AliasTable table;
    table.entries.resize(count);
    while (!small.empty()) {
        const uint32_t item = small.back();
        small.pop_back();
        // Rounding may leave no large item for the last small ones: the heaviest fills them up.
        const uint32_t filler = large.empty() ? static_cast<uint32_t>(heaviest - weights.begin()) : large.back();
        const double quanta = weights[item] > 0 ? std::max(std::floor(share[item] * word_count), 1.0) : 0.0;
        table.entries[item] = {static_cast<uint32_t>(std::min(quanta, word_count - 1)), filler};
        if (large.empty()) continue;
        share[filler] -= 1 - share[item];
        if (share[filler] < 1) {
            large.pop_back();
            small.push_back(filler);
        }
    }
    for (const uint32_t item : large) table.entries[item] = {0, item};

    // Counted in words, which is exact.
    table.probabilities.resize(count);
    for (size_t i = 0; i < count; ++i) {
        table.probabilities[i] += table.entries[i].threshold;
        table.probabilities[table.entries[i].alias] += word_count - table.entries[i].threshold;
    }
    for (double& probability : table.probabilities) probability /= word_count * static_cast<double>(count);
    return table;
}

namespace {

constexpr size_t rows_at_once = 64;

// One texel of a row averaged over its area after linear filtering: each neighbour contributes 1/8.
double filtered(double before, double here, double after) { return (before + 6 * here + after) / 8; }

// The filtered probe's mean luminance in each texel. It wraps around horizontally and ends at the poles.
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
                texels[y * width + x] = static_cast<float>(filtered(rows[(y > 0 ? y - 1 : y) * width + x], rows[y * width + x],
                                                                    rows[(y + 1 < height ? y + 1 : y) * width + x]));
    });
    return texels;
}

// The texels [first, end) that a cell overlaps along one axis.
struct Range {
    size_t first, end;
};
Range overlapped(size_t cell, size_t cells, size_t texels) {
    return {cell * texels / cells, ((cell + 1) * texels + cells - 1) / cells};
}

}  // namespace

std::vector<ProbeCell> build_probe_table(const Image& probe, double probability) {
    const std::vector<float> texels = filtered_luminances(probe);
    const size_t columns = std::min(probe.width, MAX_PROBE_CELL_COLUMNS), rows = std::min(probe.height, MAX_PROBE_CELL_ROWS);
    std::vector<double> weights(columns * rows), solid_angles(rows);
    const auto weigh_row = [&](size_t row) {
        // cos a - cos b without cancellation near the poles.
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
