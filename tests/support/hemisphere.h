// sample_hemisphere() and get_hemisphere_density() of a chapter, run on a device: see hemisphere.comp.
#pragma once
#include <string>
#include <vector>

#include "shaders/interface.h"
#include "support/gpu_test.h"

namespace lab {

struct HemisphereQuery {
    vec2 numbers;       // random numbers in [0,1)
    vec3 direction{0};  // whose density is asked for
};
struct HemisphereAnswer {
    vec3 direction;  // that the numbers give
    float density;   // of the query's direction with respect to solid angle; only chapter 2 tells
};
std::vector<HemisphereAnswer> evaluate_hemisphere(const std::string& chapter,
                                                  const std::vector<HemisphereQuery>& queries,
                                                  const Device& device = test_device());

}  // namespace lab
