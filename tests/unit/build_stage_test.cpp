// What the window repeats when its user changes options.
#include <gtest/gtest.h>

#include "rendering/build.h"

namespace lab {
namespace {

TEST(BuildStage, EachGroupOfOptionsRepeatsWhatDependsOnIt) {
    Options shown;
    shown.estimator.strategy = Strategy::both;
    struct Row {
        const char* what;
        void (*change)(Options&);
        BuildStage stage;
    };
    for (const auto& [what, change, stage] : {
             Row{"nothing", [](Options&) {}, BuildStage::nothing},
             Row{"exposure", [](Options& o) { o.appearance.exposure = 1; }, BuildStage::nothing},
             Row{"target", [](Options& o) { o.appearance.sample_count = 8; }, BuildStage::nothing},
             Row{"seed", [](Options& o) { o.samples.seed = 2; }, BuildStage::samples},
             Row{"camera", [](Options& o) { o.camera.position = vec3(1); }, BuildStage::samples},
             Row{"focus", [](Options& o) { o.camera.focus_distance = 2.0f; }, BuildStage::samples},
             Row{"aperture", [](Options& o) { o.camera.aperture_diameter = 1.0f; }, BuildStage::renderer},
             Row{"path length", [](Options& o) { o.light.max_path_length = 2; }, BuildStage::samples},
             Row{"black background", [](Options& o) { o.light.background = vec3(0); }, BuildStage::samples},
             Row{"sky", [](Options& o) { o.light.background = vec3(1); }, BuildStage::renderer},
             Row{"width", [](Options& o) { o.image.width = 8; }, BuildStage::renderer},
             Row{"other light samples", [](Options& o) { o.estimator.strategy = Strategy::light; }, BuildStage::renderer},
             Row{"no light samples", [](Options& o) { o.estimator.strategy = Strategy::bounces; }, BuildStage::gpu_scene},
             Row{"scene", [](Options& o) { o.scene.specular = true; }, BuildStage::scene},
         }) {
        Options wanted = shown;
        change(wanted);
        EXPECT_EQ(static_cast<int>(first_difference(shown, wanted)), static_cast<int>(stage)) << what;
        // Until a build is done, the window shows new samples of what it has.
        EXPECT_GE(first_difference(shown, keep_built(shown, wanted)), BuildStage::samples) << what;
    }
}

}  // namespace
}  // namespace lab
