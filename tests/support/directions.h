// Directions about a normal: where the estimators' directions are, to be compared with their density.
#pragma once
#include <glm/glm.hpp>
#include <vector>

#include "support/bounce.h"

namespace lab {

// Normals along an axis, against it, in between, and where the construction of the frame is delicate.
const std::vector<glm::dvec3>& test_normals();

// Angles of a direction with respect to a normal, in double. The azimuth, in [-π,π], counts from an arbitrary
// direction.
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

// Histogram over rows of equal size in cos θ, each with columns of equal size in φ. Of a million directions
// at most ten may be dropped: those whose cosine is so small that rounding errors bring them below the
// horizon.
std::vector<uint64_t> histogram(const std::vector<Bounce>& bounces, const Frame& frame, size_t rows, size_t columns);

// Probability of each cell of such a histogram: `integral(c)` is the probability of cos θ < c.
std::vector<double> cell_probabilities(size_t rows, size_t columns, double (*integral)(double cos_theta));

}  // namespace lab
