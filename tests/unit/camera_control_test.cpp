// The viewer's camera: its motion, and its text as flags and JSON.
#include "viewer/camera_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "rendering/settings.h"
#include "viewer/viewer.h"

namespace lab {
namespace {

constexpr CameraPose start{.position = {1, 2, 8}, .target = {1, 2, 3}, .up = {0, 1, 0}, .vertical_fov = 40};

// The camera of a scene whose diagonal is 4, so that its speed is 1.
CameraControl make_control(Navigation navigation = Navigation::first_person) {
    CameraControl control;
    control.fit_to({{0, 0, 0}, {4, 0, 0}});
    control.navigation = navigation;
    return control;
}

void expect_near(const vec3& actual, const vec3& expected, float tolerance = 1e-5f) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(actual[axis], expected[axis], tolerance) << axis;
}

TEST(CameraControl, StepsFollowTheViewAndTheSizeOfTheScene) {
    for (const Navigation navigation : {Navigation::first_person, Navigation::orbit}) {
        const CameraPose moved = make_control(navigation).move(start, {.steps = {0.5f, 0.25f, 2}});
        expect_near(moved.position, {1.5f, 2.25f, 6});  // forward is -Z, right is +X
        expect_near(moved.target, {1.5f, 2.25f, 1});
    }
    CameraControl large = make_control();
    large.fit_to({{0, 0, 0}, {400, 0, 0}});
    expect_near(large.move(start, {.steps = {0, 0, 1}}).position, {1, 2, -92});
}

TEST(CameraControl, DraggingTurnsTheHeadInPlace) {
    // A quarter turn to the right: dragging by the height of the picture turns by two radians.
    const float quarter = 3.14159265f / 4;
    const CameraPose turned = make_control().move(start, {.drag = {quarter, 0}});
    expect_near(turned.position, start.position);
    expect_near(turned.target, {6, 2, 8});
    // Down in the picture is down in the scene.
    EXPECT_LT(make_control().move(start, {.drag = {0, 0.1f}}).target.y, start.target.y);
}

TEST(CameraControl, DraggingOrbitsAroundTheTarget) {
    const float quarter = 3.14159265f / 4;
    const CameraPose turned = make_control(Navigation::orbit).move(start, {.drag = {quarter, 0}});
    expect_near(turned.target, start.target);
    expect_near(turned.position, {-4, 2, 3});
}

TEST(CameraControl, LookingUpStopsBeforeTheVertical) {
    for (const float direction : {-1.0f, 1.0f}) {
        CameraControl control = make_control();
        CameraPose pose = start;
        for (int i = 0; i < 20; ++i) pose = control.move(pose, {.drag = {0, 0.3f * direction}});
        const vec3 view = glm::normalize(pose.target - pose.position);
        EXPECT_LT(std::abs(view.y), 0.9995f);
        EXPECT_GT(std::abs(view.y), 0.99f);
        // It has not turned over the top.
        EXPECT_LT(view.z, 0);
        EXPECT_NEAR(view.x, 0, 1e-5);
    }
}

TEST(CameraControl, TheWheelChangesTheSpeedOrTheDistance) {
    CameraControl walking = make_control();
    const CameraPose same = walking.move(start, {.zoom = 3});
    expect_near(same.position, start.position, 0);
    EXPECT_NEAR(walking.speed(), std::pow(1.2, 3), 1e-4);
    const CameraPose nearer = make_control(Navigation::orbit).move(start, {.zoom = 1});
    expect_near(nearer.target, start.target, 0);
    EXPECT_NEAR(glm::distance(nearer.position, nearer.target), 4.5, 1e-5);
}

TEST(CameraControl, TheCameraNeverReachesItsTarget) {
    CameraControl control = make_control(Navigation::orbit);
    CameraPose pose = start;
    for (int i = 0; i < 1000; ++i) pose = control.move(pose, {.zoom = 10});
    EXPECT_NO_THROW(make_camera(pose, 64, 64));
}

TEST(CameraControl, TheTextsAreExact) {
    const CameraPose pose{
        .position = {1.0f / 3, -2e-7f, 12345.678f}, .target = {0.1f, 0.2f, 0.3f}, .up = {0, 0, 1}, .vertical_fov = 37.7f};
    EXPECT_EQ(camera_flags(pose, '='),
              "--camera-position=0.333333343,-2.00000002e-07,12345.6777 --camera-target=0.100000001,0.200000003,"
              "0.300000012 --camera-up=0,0,1 --vertical-fov=37.7000008");
    const auto json = nlohmann::json::parse("{" + camera_json(pose) + "}").at("camera");
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(json.at("position").at(static_cast<size_t>(axis)).get<float>(), pose.position[axis]);
        EXPECT_EQ(json.at("target").at(static_cast<size_t>(axis)).get<float>(), pose.target[axis]);
        EXPECT_EQ(json.at("up").at(static_cast<size_t>(axis)).get<float>(), pose.up[axis]);
    }
    EXPECT_EQ(json.at("vertical_fov").get<float>(), pose.vertical_fov);
    EXPECT_FALSE(json.contains("aperture_diameter"));
    CameraPose with_lens = pose;
    with_lens.aperture_diameter = 0.1f;
    with_lens.focus_distance = 2.5f;
    EXPECT_EQ(camera_flags(with_lens, '='), camera_flags(pose, '=') + " --aperture-diameter=0.100000001 --focus-distance=2.5");
    const auto lens = nlohmann::json::parse("{" + camera_json(with_lens) + "}").at("camera");
    EXPECT_EQ(lens.at("aperture_diameter").get<float>(), with_lens.aperture_diameter);
    EXPECT_EQ(lens.at("focus_distance").get<float>(), with_lens.focus_distance);
}

TEST(FramePacing, AFastDeviceHoldsTheRateOfItsDisplay) {
    for (const double period : {1 / 60.0, 1 / 144.0}) EXPECT_NEAR(rendering_seconds(period, 0.001) + 0.001, period, 1e-12);
}

TEST(FramePacing, ASlowInterfaceLeavesMostOfTheTimeButKeepsFiveFramesASecond) {
    EXPECT_NEAR(rendering_seconds(1 / 60.0, 0.02), 0.06, 1e-12);
    for (const double seconds : {0.0, 0.01, 0.03, 0.06, 0.1, 0.15})
        EXPECT_LE(rendering_seconds(1 / 60.0, seconds) + seconds, 0.2) << seconds;
    EXPECT_GT(rendering_seconds(1 / 60.0, 10), 0) << "a picture appears, however slow the interface is";
}

}  // namespace
}  // namespace lab
