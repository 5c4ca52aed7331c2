// The device's own arithmetic: is it within Vulkan's guarantees, and what do the shaders make of it?
#include <cmath>
#include <cstdio>

#include "support/device_arithmetic.h"
#include "support/gpu_test.h"

namespace lab {
namespace {

TEST(DeviceArithmetic, IsAboutWhatVulkanGuarantees) {
    // A driver that just misses a guarantee is reported, not failed: we cannot fix it.
    std::string outside;
    for (const FunctionError& error : measure_functions(test_device())) {
        EXPECT_TRUE(std::isfinite(error.ulps)) << error.name;
        EXPECT_LT(error.share_of_guarantee, 1.5) << error.name << ", guaranteed: " << error.guaranteed;
        if (error.share_of_guarantee <= 1) continue;
        char text[80];
        std::snprintf(text, sizeof text, "%s%s by a factor of %.2f", outside.empty() ? "" : ", ", error.name.c_str(),
                      error.share_of_guarantee);
        outside += text;
    }
    record("outside_of_vulkans_guarantees", "%s", outside.empty() ? "nothing" : outside.c_str());
    const Arithmetic& errors = test_arithmetic();
    record("sin_and_cos", "%.1e", errors.sine);
    record("quotients_and_roots", "%.1e relative", errors.division);
    record("decoding_of_srgb", "%.1e relative", errors.decoding);
    record("phong_lobe_of_exponent_1000", "%.1e relative", errors.phong_lobe);
}

TEST(DeviceArithmetic, MakesSamplersExact) {
    for (const SamplerError& error : measure_samplers(test_device()))
        // Two angles and their products; a root and a product.
        EXPECT_LT(error.absolute, 3 * test_arithmetic().sine + 4 * test_arithmetic().division + 1e-6) << error.name;
}

TEST(DeviceArithmetic, KeepsHitPointsWithinTheOffset) {
    double off_plane = 0, off_ray = 0;
    for (const HitPointError& error : measure_hit_points(test_device())) {
        // The next ray starts a whole offset away from the triangle.
        EXPECT_LT(error.off_plane, 0.5) << to_string(error.backend) << ", " << error.scene;
        off_plane = std::max(off_plane, error.off_plane);
        off_ray = std::max(off_ray, error.off_ray);
    }
    record("largest_distance_to_the_plane", "%.2f offsets", off_plane);
    record("largest_distance_to_the_ray", "%.1e of its length", off_ray);
}

}  // namespace
}  // namespace lab
