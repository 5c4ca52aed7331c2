#include <cmath>

#include "error.h"
#include "scene/scene.h"

namespace lab {

using glm::dvec3;

CameraPose framing_pose(const Bounds& bounds) {
    const dvec3 low(bounds.low), high(bounds.high);
    const dvec3 centre = 0.5 * (low + high);
    // The bounding sphere touches the upper and lower edge of the image.
    CameraPose pose;
    const double radius = 0.5 * glm::distance(low, high);
    const double distance = radius / std::sin(glm::radians(0.5 * pose.vertical_fov));
    pose.position = vec3(centre + distance * glm::normalize(dvec3(0, 0.25, 1)));
    pose.target = vec3(centre);
    return pose;
}

Camera make_camera(const CameraPose& pose, uint32_t width, uint32_t height) {
    const dvec3 direction = dvec3(pose.target) - dvec3(pose.position);
    const double distance = glm::length(direction);
    if (!(distance > 0) || !std::isfinite(distance))
        throw UserError("camera: position and target must be finite and differ");
    if (!(pose.vertical_fov > 0 && pose.vertical_fov < 180))
        throw UserError("camera: the vertical field of view must be above 0 and below 180 degrees");
    const dvec3 forward = direction / distance;

    // Looking along `up` leaves the camera's roll open: then -Z (or +Y) is up in the image.
    dvec3 up(pose.up);
    const double up_length = glm::length(up);
    if (!(up_length > 0) || !std::isfinite(up_length))
        throw UserError("camera: up must be finite and not zero");
    if (glm::length(glm::cross(forward, up)) <= 1e-6 * up_length)
        up = std::abs(forward.y) > 0.5 ? dvec3(0, 0, -1) : dvec3(0, 1, 0);
    const dvec3 right = glm::normalize(glm::cross(forward, up));

    const double tangent = std::tan(glm::radians(0.5 * pose.vertical_fov));
    Camera camera;
    camera.position = pose.position;
    camera.forward = vec3(forward);
    camera.right = vec3(tangent * width / height * right);
    camera.up = vec3(tangent * glm::cross(right, forward));
    return camera;
}

}  // namespace lab
