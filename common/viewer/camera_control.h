// Moves a camera by mouse and keyboard input.
#pragma once
#include <string>

#include "scene/scene.h"

namespace lab {

enum class Navigation { first_person, orbit };

// The user's input since the last frame.
struct CameraMotion {
    vec3 steps{0};   // right, up and forward, in seconds of motion
    vec2 drag{0};    // of the mouse, relative to the picture's height; right and down are positive
    float zoom = 0;  // notches of the wheel, forward is positive

    bool is_none() const { return steps == vec3(0) && drag == vec2(0) && zoom == 0; }
};

class CameraControl {
  public:
    // Adapts the speed to the size of the scene.
    void fit_to(const Bounds& bounds);

    // First person: dragging turns the head, the wheel changes the speed. Orbit: dragging turns the camera about its target, the
    // wheel changes the distance. Steps move both camera and target. `up` remains the upright axis.
    CameraPose move(const CameraPose& pose, const CameraMotion& motion);

    Navigation navigation = Navigation::first_person;
    float speed() const { return speed_; }  // scene units per second

  private:
    float size_ = 1;  // diagonal of the scene
    float speed_ = 0.25f;
};

// The pose as the value of "camera" in a scene file. The numbers are exact.
std::string camera_json(const CameraPose& pose);

}  // namespace lab
