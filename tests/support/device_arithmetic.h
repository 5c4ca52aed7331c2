// How accurate a device's arithmetic is: largest errors against double, over the ranges that the shaders use.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "support/render.h"

namespace lab {

// The largest errors of a function.
struct FunctionError {
    std::string name;
    std::string range;                              // of the arguments
    std::string guaranteed;                         // by Vulkan, "Precision and Operation of SPIR-V Instructions"; "-": nothing
    std::optional<double> absolute = std::nullopt;  // not for results of all magnitudes
    double ulps = 0;                                // in units in the last place of the exact value
    double share_of_guarantee = 0;                  // above 1 the device violates it; 0 if there is none
};
// Examines `count` random arguments spread over the range.
std::vector<FunctionError> measure_functions(const Device& device, size_t count = 1 << 20);

// The largest deviation of a sampler's results from what they should be: unit directions, barycentric coordinates.
struct SamplerError {
    std::string name;
    double absolute = 0;
};
std::vector<SamplerError> measure_samplers(const Device& device);

// Where camera rays hit a scene, compared with the exact intersection of the same ray and triangle.
struct HitPointError {
    Backend backend;
    std::string scene;
    double off_plane = 0;  // distance to the triangle's plane, in units of the offset at which rays start
    double off_ray = 0;    // distance to the ray, relative to its length
};
std::vector<HitPointError> measure_hit_points(const Device& device);

// The basis of the tests' tolerances: largest errors of this device. Measured once.
struct Arithmetic {
    double sine;        // absolute, of sin and cos in [-π,π]
    double decoding;    // relative, of x^2.4, which decodes sRGB
    double phong_lobe;  // relative, of x^n for n up to 1000
    double division;    // relative, of quotients and square roots
};
const Arithmetic& test_arithmetic();

}  // namespace lab
