// How the error of a render falls with the number of samples.
#pragma once
#include <string>

#include "support/render.h"

namespace lab {

struct ErrorSlope {
    double value;  // of log(error) over log(samples): -1/2 for independent samples of finite variance
    double standard_error;
    std::string variances;  // of a sample, estimated at 1, 4, 16, ... samples, for messages
};

// How far a slope may be from -1/2, and how accurately it must be known for this test: the tolerance is nearly six standard
// errors, so that a false alarm is less likely than in other expectations, and a slope that is off by 0.07 is found with
// probability 0.99.
inline constexpr double slope_tolerance = 0.05, largest_slope_error = 0.0085;

// Renders with 1, 4, 16, ... samples up to max_samples, twice each, with different seeds that follow settings.seed. The error is
// the root mean square over the pixels of a group, averaged over groups by its logarithm.
ErrorSlope measure_error_slope(const Scene& scene, RenderSettings settings, uint32_t max_samples);

}  // namespace lab
