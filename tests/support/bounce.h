// Runs an estimator at a single surface point, see shaders/observation/estimator_stub.glsl.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "shaders/interface.h"
#include "support/gpu_test.h"
#include "support/pcg2d.h"

namespace lab {

struct Surface {
    vec3 normal{0, 0, 1};
    vec3 out_direction{0, 0, 1};  // towards the camera
    Material material;
};

// A Lambertian material that reflects everything.
Material white_material();

struct Bounce {
    vec3 direction;
    float weight;        // of the direction: π ρ cosθ / (π density), the radiance under a sky of radiance 1
    uint32_t ray_count;  // 2, or 1 if the estimator rejected the direction
};

// Bounces with the random numbers of different samples. `run` selects different ones.
std::vector<Bounce> sample_bounces(const std::string& chapter, const Surface& surface, size_t count, uint32_t run);

// Bounces with given first two random numbers (rounded down to multiples of 2^-24).
std::vector<Bounce> bounces_at(const std::string& chapter, const Surface& surface,
                               const std::vector<std::array<double, 2>>& numbers, const Device& device = test_device());

// Bounces at white_material() that Russian roulette with this survival probability lets through, from given random states.
std::vector<Bounce> bounces_with_roulette(const std::string& chapter, float survival_probability,
                                          const std::vector<RandomState>& seeds);

// For INSTANTIATE_TEST_SUITE_P: names the instances after their chapters. Those that sample the BSDF by the file of an earlier
// chapter run only with --all: what that file gets wrong, the test of the earlier chapter finds.
std::string bsdf_name(const testing::TestParamInfo<std::string>& info);

}  // namespace lab
