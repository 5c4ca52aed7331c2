// This folder's estimators count what rays do instead of carrying light, on every backend.
#pragma once
#include <string>

#include "support/render.h"

namespace lab {

// The estimator in tests/hard_cases/NAME.glsl.
Estimator probe(const std::string& name);

// What the probe returned, summed over all samples of all pixels.
glm::dvec3 probe_total(const Scene& scene, const RenderSettings& settings);

// All of these chapters for `compute`, only the first for the other backends: where chapters differ does not depend on the
// backend. For scenes without glass.
std::vector<std::string> chapters_for(Backend backend, std::vector<std::string> all);

// Sum over all emissive triangles of the probability that estimators divide by; for scenes of untransformed instances.
double light_probability_sum(const Scene& scene);

// For RecordProperty: "3 of 1e+06".
std::string out_of(double count, double total);
// "-0.12 %".
std::string percent(double fraction);

}  // namespace lab
