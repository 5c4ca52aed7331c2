// --view idle-lanes: the fraction of time that a thread waits for the others in its subgroup.
#include <cstdio>

#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

const std::string without_regeneration = chapter_named("low_discrepancy_points"),
                  with_regeneration = chapter_named("path_regeneration");

// The mean over an image whose size is not a multiple of the block size.
double idle_part(const Scene& scene, const std::string& chapter, RenderSettings settings) {
    settings.width = 52;
    settings.height = 36;
    settings.samples = 1;
    settings.estimator = view_estimator("idle-lanes", chapter);
    const Image image = render(scene, settings).mean();
    double sum = 0;
    for (const float part : image.pixels) {
        EXPECT_GE(part, 0.0f);
        EXPECT_LT(part, 1.0f);
        sum += part;
    }
    return sum / static_cast<double>(image.pixels.size());
}

TEST(IdleLanes, AreNoneWherePathsAreEquallyLong) {
    const Scene scene = closed_box(diffuse_material(vec3(1)));
    for (const std::string& chapter : {without_regeneration, with_regeneration})
        EXPECT_LT(idle_part(scene, chapter, {.max_path_length = 5, .roulette_start = no_roulette}), 1e-3) << chapter;
}

TEST(IdleLanes, AreFewWhereThreadsStartTheirNextPathAtOnce) {
    const auto properties =
        test_device().physical().getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupProperties>();
    if (properties.get<vk::PhysicalDeviceSubgroupProperties>().subgroupSize == 1)
        GTEST_SKIP() << "the groups of this device have a single thread each: nobody waits";
    const Scene scene = load_shipped_scene("cornell_box.json");
    const double before = idle_part(scene, without_regeneration, {}), now = idle_part(scene, with_regeneration, {});
    std::printf("  idle: %.3f without path regeneration, %.3f with it\n", before, now);
    EXPECT_GT(before, 0.2);
    EXPECT_LT(now, 0.5 * before);
}

}  // namespace
}  // namespace lab
