#include "inside/projection.h"

#include <gtest/gtest.h>

#include "scene/scene.h"

namespace lab {
namespace {

const Camera camera =
    make_camera({.position = {1, 2, 5}, .target = {1, 2, 0}, .up = {0, 1, 0}, .vertical_fov = 90}, 200, 100);

void expect_at(const std::optional<vec2>& position, float x, float y) {
    ASSERT_TRUE(position);
    EXPECT_NEAR(position->x, x, 1e-5f);
    EXPECT_NEAR(position->y, y, 1e-5f);
}

TEST(Projection, IsTheInverseOfTheCamerasRays) {
    // As in shaders/camera.glsl.
    for (const vec2 image : {vec2(0, 0), vec2(1, 1), vec2(0.3f, 0.8f), vec2(-0.5f, 1.5f)}) {
        const vec2 p = 2.0f * image - 1.0f;
        const vec3 direction = camera.forward + p.x * camera.right - p.y * camera.up;
        expect_at(project(camera, camera.position + 3.7f * direction), image.x, image.y);
    }
    expect_at(project(camera, {1, 7, 0}), 0.5f, 0);  // 45 degrees up
    EXPECT_FALSE(project(camera, {1, 2, 6}));
    EXPECT_FALSE(project(camera, camera.position));
}

TEST(Projection, CutsSegmentsThatReachBehindTheCamera) {
    const auto whole = project_segment(camera, {1, 2, 0}, {1, 7, 0});
    ASSERT_TRUE(whole);
    expect_at((*whole)[0], 0.5f, 0.5f);
    expect_at((*whole)[1], 0.5f, 0);
    const auto cut = project_segment(camera, {1, 3, 0}, {1, 3, 20});
    ASSERT_TRUE(cut);
    expect_at((*cut)[0], 0.5f, 0.4f);
    EXPECT_NEAR((*cut)[1].x, 0.5f, 1e-4f);
    EXPECT_LT((*cut)[1].y, -10);  // far above the picture
    const auto reversed = project_segment(camera, {1, 3, 20}, {1, 3, 0});
    ASSERT_TRUE(reversed);
    EXPECT_EQ((*reversed)[1], (*cut)[0]);
    EXPECT_FALSE(project_segment(camera, {1, 3, 8}, {1, 3, 20}));
}

}  // namespace
}  // namespace lab
