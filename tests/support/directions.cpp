#include "support/directions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lab {

using glm::dvec3;
using std::numbers::pi;

const std::vector<dvec3>& test_normals() {
    static const std::vector<dvec3> normals{
        {0, 0, 1}, {0, 0, -1}, glm::normalize(dvec3(0.3, -0.8, 0.52)), glm::normalize(dvec3(-0.00019813581, -0.00008946839, -1))};
    return normals;
}

Frame::Frame(const dvec3& normal)
    : normal_(dvec3(vec3(normal))),
      tangent_(glm::normalize(glm::cross(normal_, dvec3(0.36, 0.48, 0.8)))),
      bitangent_(glm::cross(normal_, tangent_)) {}

Angles Frame::angles(const vec3& direction) const {
    const dvec3 d(direction);
    const double x = glm::dot(d, tangent_), y = glm::dot(d, bitangent_);
    return {glm::dot(d, normal_), std::hypot(x, y), std::atan2(y, x)};
}

std::vector<uint64_t> histogram(const std::vector<Bounce>& bounces, const Frame& frame, size_t rows, size_t columns) {
    std::vector<uint64_t> counts(rows * columns);
    size_t dropped = 0;
    for (const Bounce& bounce : bounces) {
        if (bounce.ray_count != 2) {
            ++dropped;
            continue;
        }
        const Angles angles = frame.angles(bounce.direction);
        const auto index = [](double position, size_t count) {
            return static_cast<size_t>(std::clamp(position, 0.0, 1 - 1e-12) * static_cast<double>(count));
        };
        ++counts[index(angles.cos_theta, rows) * columns + index((angles.phi + pi) / (2 * pi), columns)];
    }
    EXPECT_LE(dropped, bounces.size() / 100'000);
    return counts;
}

std::vector<double> cell_probabilities(size_t rows, size_t columns, double (*integral)(double cos_theta)) {
    std::vector<double> probabilities;
    for (size_t row = 0; row < rows; ++row) {
        const auto edge = [&](size_t i) { return static_cast<double>(i) / static_cast<double>(rows); };
        const double probability = integral(edge(row + 1)) - integral(edge(row));
        probabilities.insert(probabilities.end(), columns, probability / static_cast<double>(columns));
    }
    return probabilities;
}

}  // namespace lab
