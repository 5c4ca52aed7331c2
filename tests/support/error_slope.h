// How the error of a render falls with the number of samples.
#pragma once
#include <string>

#include "support/render.h"

namespace lab {

struct ErrorSlope {
    double value;  // of log(error) over log(samples): -1/2 for independent samples of finite variance
    double standard_error;
    std::string variances;  // of a sample as 1, 4, 16, ... samples show it, for messages
};

// How far from -1/2 a slope may be.
inline constexpr double slope_tolerance = 0.05;

// Renders with 1, 4, 16, ... samples up to max_samples, twice each with seeds of their own that follow
// settings.seed. The error is the root mean square over the pixels of a group, averaged over groups by its
// logarithm.
ErrorSlope measure_error_slope(const Scene& scene, RenderSettings settings, uint32_t max_samples);

}  // namespace lab
