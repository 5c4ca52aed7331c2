// Camera ray x_0, ω_0 through a point of the image: (0,0) is its upper left corner, (1,1) its lower right one.
Ray get_camera_ray(vec2 image_position) {
    Camera camera = parameters.camera;
    vec2 position = 2.0 * image_position - 1.0;
    return Ray(camera.position, normalize(camera.forward + position.x * camera.right - position.y * camera.up));
}
