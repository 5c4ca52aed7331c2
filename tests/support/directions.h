// Directions about a normal: the distribution of the estimators' directions, to be compared with their density.
#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "support/bounce.h"

namespace lab {

// Normals along both directions of each axis, in between, and where constructing the frame is numerically delicate.
const std::vector<glm::dvec3>& test_normals();

// Angles of a direction relative to a normal, in double. The azimuth, in [-π,π], starts at an arbitrary direction.
struct Angles {
    double cos_theta, sin_theta, phi;
};
class Frame {
  public:
    explicit Frame(const glm::dvec3& normal);
    Angles angles(const vec3& direction) const;

  private:
    glm::dvec3 normal_, tangent_, bitangent_;
};

// Histogram with rows of equal size in cos θ and columns of equal size in φ. Of a million directions at most ten may be dropped:
// those with so small a cosine that rounding brings them below the horizon.
std::vector<uint64_t> histogram(const std::vector<Bounce>& bounces, const Frame& frame, size_t rows, size_t columns);

// Probability of each cell of such a histogram: `integral(c)` is the probability of cos θ < c.
std::vector<double> cell_probabilities(size_t rows, size_t columns, double (*integral)(double cos_theta));

}  // namespace lab
