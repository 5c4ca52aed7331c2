// Estimators of this folder that count what rays do instead of carrying light, on every backend.
#pragma once
#include <string>

#include "support/render.h"

namespace lab {

// tests/hard_cases/NAME.glsl.
Estimator probe(const std::string& name);

// What the probe returned, added over all samples of all pixels.
glm::dvec3 probe_total(const Scene& scene, const RenderSettings& settings);

// All these chapters for `compute`, the first for the other backends: what chapters do differently does not
// depend on them. For scenes without glass.
std::vector<std::string> chapters_for(Backend backend, std::vector<std::string> all);

// Of all emissive triangles, as the estimators divide by them; for scenes of untransformed instances.
double light_probability_sum(const Scene& scene);

// For RecordProperty: "3 of 1e+06".
std::string out_of(double count, double total);
// "-0.12 %".
std::string percent(double fraction);

}  // namespace lab
