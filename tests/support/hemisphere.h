// sample_hemisphere() of a chapter, run on a device: see hemisphere.comp.
#pragma once
#include <string>
#include <vector>

#include "shaders/interface.h"
#include "support/gpu_test.h"

namespace lab {

// The directions for pairs of random numbers in [0,1).
std::vector<vec3> sample_hemisphere(const std::string& chapter, const std::vector<vec2>& numbers,
                                    const Device& device = test_device());

}  // namespace lab
