// A pinhole. A chapter's folder may bring its own camera in a file of this name.

// Camera ray x_0, ω_0 through a point of the image: (0,0) is its upper left corner, (1,1) its lower right one.
Ray get_camera_ray(vec2 image_position) {
    Camera camera = parameters.camera;
    vec2 position = 2.0 * image_position - 1.0;
    return Ray(camera.position, normalize(camera.forward + position.x * camera.right - position.y * camera.up));
}

// The camera ray through a random point of a pixel.
Ray sample_camera_ray(uvec2 pixel, inout uvec2 seed) {
    return get_camera_ray((vec2(pixel) + get_random_numbers(seed)) / vec2(parameters.image_size));
}
