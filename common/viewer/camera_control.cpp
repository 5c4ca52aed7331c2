#include "viewer/camera_control.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "rendering/numbers_text.h"

namespace lab {
namespace {

using glm::dvec3;

constexpr double radians_per_height = 2;    // per picture height dragged
constexpr double speed_per_notch = 1.2;     // of the wheel
constexpr double distance_per_notch = 0.9;  // in orbit
constexpr double steepest_sine = 0.999;     // of elevation: beyond it, left and right would swap

dvec3 rotate(const dvec3& v, double angle, const dvec3& axis) { return glm::angleAxis(angle, axis) * v; }

// Turns a direction about the upright axis, then up or down, but never past that axis.
dvec3 turn(dvec3 direction, const dvec3& up, double right_angle, double up_angle) {
    direction = rotate(direction, -right_angle, up);
    const double elevation = std::asin(std::clamp(glm::dot(direction, up), -1.0, 1.0));
    const double limit = std::asin(steepest_sine);
    const double turned = std::clamp(elevation + up_angle, std::min(-limit, elevation), std::max(limit, elevation));
    dvec3 level = direction - glm::dot(direction, up) * up;
    if (glm::length(level) < 1e-9) return direction;  // straight up: no heading to turn
    level = glm::normalize(level);
    return std::cos(turned) * level + std::sin(turned) * up;
}

}  // namespace

void CameraControl::fit_to(const Bounds& bounds) {
    const float diagonal = glm::distance(bounds.low, bounds.high);
    size_ = std::isfinite(diagonal) && diagonal > 0 ? diagonal : 1;
    speed_ = 0.25f * size_;  // crosses the scene in four seconds
}

CameraPose CameraControl::move(const CameraPose& pose, const CameraMotion& motion) {
    const dvec3 up = glm::normalize(dvec3(pose.up));
    dvec3 position(pose.position), target(pose.target);
    const double distance = glm::distance(position, target);
    dvec3 forward = (target - position) / distance;
    if (motion.drag != vec2(0))
        forward = turn(forward, up, radians_per_height * motion.drag.x, -radians_per_height * motion.drag.y);
    if (navigation == Navigation::first_person) {
        target = position + distance * forward;
        speed_ = static_cast<float>(std::clamp(speed_ * std::pow(speed_per_notch, motion.zoom), 1e-4 * size_, 1e2 * size_));
    } else {
        const double closer = distance * std::pow(distance_per_notch, motion.zoom);
        position = target - std::clamp(closer, 1e-4 * size_, std::max(1e3 * size_, distance)) * forward;
    }
    dvec3 right = glm::cross(forward, up);
    right = glm::length(right) > 1e-9 ? glm::normalize(right) : dvec3(0);
    const dvec3 step =
        double{speed_} * (double{motion.steps.x} * right + double{motion.steps.y} * up + double{motion.steps.z} * forward);
    CameraPose moved = pose;
    moved.position = vec3(position + step);
    moved.target = vec3(target + step);
    // Far from the origin both may round to the same point.
    return moved.position == moved.target ? pose : moved;
}

std::string camera_json(const CameraPose& pose) {
    const auto array = [](const vec3& v) { return "[" + exact_text(v, ", ") + "]"; };
    std::string lens;
    if (pose.aperture_diameter > 0) {
        lens = ", \"aperture_diameter\": " + exact_text(pose.aperture_diameter);
        if (pose.focus_distance > 0) lens += ", \"focus_distance\": " + exact_text(pose.focus_distance);
    }
    return "\"camera\": {\"position\": " + array(pose.position) + ", \"target\": " + array(pose.target) +
           ", \"up\": " + array(pose.up) + ", \"vertical_fov\": " + exact_text(pose.vertical_fov) + lens + "}";
}

}  // namespace lab
