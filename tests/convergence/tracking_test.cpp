// Delta tracking and ratio tracking alone, through grids of densities, against quadrature along the ray in double.
#include <algorithm>
#include <cmath>

#include "files/project_folder.h"
#include "support/expect_statistics.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;

Scene in_grid(const uvec3& size, const std::vector<float>& densities, float extinction = 1) {
    Scene scene = closed_box(diffuse_material(vec3(0.5f)));
    Medium medium = homogeneous_medium(extinction, vec3(0.5f));
    medium.grid_size = size;
    medium.largest_density = *std::ranges::max_element(densities);
    medium.low = {-1, -0.5f, -2};
    medium.high = {1, 1, 2};
    scene.media = {medium};
    scene.densities = densities;
    return scene;
}

// Trilinear between the centres of cells, 0 outside.
double density_at(const Scene& scene, const dvec3& position) {
    const Medium& medium = scene.media[0];
    const dvec3 low(medium.low), high(medium.high), size(medium.grid_size);
    if (glm::any(glm::lessThan(position, low)) || glm::any(glm::greaterThan(position, high))) return 0;
    const dvec3 place = glm::clamp((position - low) / (high - low) * size - 0.5, dvec3(0), size - 1.0), first = glm::floor(place);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 offset(corner & 1, corner >> 1 & 1, corner >> 2), cell = glm::min(first + offset, size - 1.0);
        const dvec3 weights = glm::mix(1.0 - (place - first), place - first, offset);
        sum += weights.x * weights.y * weights.z *
               double{scene.densities[static_cast<size_t>(cell.x + size.x * (cell.y + size.y * cell.z))]};
    }
    return sum;
}

// From one point towards another. The fewer rays pass, the more samples it takes to count them.
void expect_tracking(Scene scene, const std::string& name, const vec3& from, const vec3& to, uint32_t samples,
                     double largest_bias = 0.01) {
    scene.camera = {.position = from, .target = to, .up = {0.1f, 1, 0.2f}, .vertical_fov = 1e-6f};
    const dvec3 direction = glm::normalize(dvec3(to) - dvec3(from));
    const double extinction = scene.media[0].extinction;
    // Only the part near the box counts; the midpoint rule has an error of 1e-6 there.
    const double middle = glm::length(dvec3(from)), first = std::max(middle - 4, 0.0), last = middle + 4;
    constexpr int steps = 400'000;
    double depth = 0, mean_flight = 0;
    for (int i = 0; i < steps; ++i) {
        const double t = first + (last - first) * (i + 0.5) / steps;
        const double part = extinction * density_at(scene, dvec3(from) + t * direction) * (last - first) / steps;
        mean_flight += t * (std::exp(-depth) - std::exp(-depth - part));
        depth += part;
    }
    const RenderSettings settings{.width = 64,
                                  .height = 64,
                                  .samples = samples,
                                  .estimator = {.file = project_folder() / "tests/convergence/tracking.glsl",
                                                .observed = project_folder() / "chapters/13_media/path_trace.glsl"},
                                  .backend = fastest_backend()};
    const Batches batches = render_batches(scene, settings, 32);
    expect_mean(name + ", ratio tracking", estimate_mean(batches.means(0)), std::exp(-depth), largest_bias, 6);
    expect_mean(name + ", delta tracking", estimate_mean(batches.means(1)), std::exp(-depth), largest_bias, 6);
    expect_mean(name + ", mean flight", estimate_mean(batches.means(2)), mean_flight, largest_bias, 6);
}

TEST(Tracking, ThroughARampFindsItsIntegral) {
    const Scene scene = in_grid({1, 1, 6}, {0, 0.2f, 0.4f, 0.6f, 0.8f, 1});
    expect_tracking(scene, "along the ramp", {0, 0, 2.5f}, {0, 0, 0}, 16);
    expect_tracking(scene, "back", {0, 0, -2.5f}, {0, 0, 0}, 64);
    expect_tracking(scene, "from within", {0.2f, 0.3f, 0.5f}, {-3, 2, -4}, 16);
}

TEST(Tracking, ThroughCellsOfAllKindsFindsItsIntegral) {
    std::vector<float> densities;
    for (int i = 0; i < 4 * 3 * 5; ++i) densities.push_back(i % 3 == 0 ? 0 : static_cast<float>(i * 7 % 11) / 10);
    const Scene scene = in_grid({4, 3, 5}, densities, 1.5f);
    expect_tracking(scene, "across", {3, 2, 3}, {-0.2f, 0.1f, -0.1f}, 40);
    expect_tracking(scene, "parallel to an axis, along a face", {-0.9999f, 0.2f, 3}, {-0.9999f, 0.2f, 0}, 64);
    expect_tracking(scene, "from a face", {0.3f, 1, 0.2f}, {-0.1f, -1, 0}, 16);
    expect_tracking(scene, "past the box", {0, 3, 3}, {0.5f, 1.4f, 0}, 8);
}

TEST(Tracking, ThroughOneCellAmongZerosFindsItsIntegral) {
    std::vector<float> densities(27, 0);
    densities[13] = 1e4f;
    const Scene scene = in_grid({3, 3, 3}, densities, 2e-4f);
    expect_tracking(scene, "through its middle", {0, 0.25f, 3}, {0, 0.25f, 0}, 64);
    expect_tracking(scene, "past it", {0.4f, 0.2f, 3}, {0.5f, 0.25f, 0}, 4, 0.02);
    expect_tracking(scene, "from far away", {0, 0.25f, 3000}, {0, 0.25f, 0}, 64);
}

}  // namespace
}  // namespace lab
