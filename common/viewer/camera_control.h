// Moves a camera as mouse and keyboard say: pure arithmetic.
#pragma once
#include <string>

#include "scene/scene.h"

namespace lab {

enum class Navigation { first_person, orbit };

// What the user did since the last frame.
struct CameraMotion {
    vec3 steps{0};   // to the right, up and forward, in units of the speed times seconds
    vec2 drag{0};    // of the mouse, in fractions of the picture's height; right and down are positive
    float zoom = 0;  // notches of the wheel, forward is positive

    bool is_none() const { return steps == vec3(0) && drag == vec2(0) && zoom == 0; }
};

class CameraControl {
  public:
    // Speed and steps follow the size of what is looked at.
    void fit_to(const Bounds& bounds);

    // First person: the drag turns the head, the wheel changes the speed. Orbit: the drag turns the camera
    // about its target, the wheel brings it nearer. Steps move camera and target in either. `up` stays the
    // axis that is upright in the picture.
    CameraPose move(const CameraPose& pose, const CameraMotion& motion);

    Navigation navigation = Navigation::first_person;
    float speed() const { return speed_; }  // scene units a second

  private:
    float size_ = 1;  // diagonal of the scene
    float speed_ = 0.25f;
};

// The pose as the value of "camera" in a scene file. The numbers are exact.
std::string camera_json(const CameraPose& pose);

}  // namespace lab
