// A thin lens: an aperture, and a plane in focus.
#ifndef FEATURE_LENS
#include "world/camera.glsl"
#else

// The third and fourth dimension of Sobol's sequence, with their bits reversed: the sum modulo 2 of a direction number for each
// digit 1 of the index. The direction numbers follow the primitive polynomials x² + x + 1 and x³ + x + 1 (Joe and Kuo,
// "Constructing Sobol Sequences with Better Two-Dimensional Projections", 2008). The first two dimensions are those of chapter 9.
uvec2 get_further_dimensions(uint index) {
    uvec2 point = uvec2(0u), third = uvec2(1u, 3u);
    uvec3 fourth = uvec3(1u, 3u, 4u);
    for (; index != 0u; index >>= 1u) {
        if ((index & 1u) != 0u) point ^= uvec2(third.x, fourth.x);
        third = uvec2(third.y, third.y ^ third.x ^ (third.x << 2u));
        fourth = uvec3(fourth.yz, fourth.y ^ fourth.x ^ (fourth.x << 3u));
    }
    return point;
}

// One point in four dimensions, for what belongs together: two pairs of numbers in one order (Burley 2020). Two points of
// chapter 9, each in an order of its own, fill only the two squares evenly, and not all combinations of places in both.
void get_joint_numbers(inout uvec2 seed, out vec2 first, out vec2 second) {
    uvec2 keys = uvec2(seed.y, 0u);
    advance_random_state(keys);
    uint index = bitfieldReverse(scramble_reversed(bitfieldReverse(seed.x), keys.x));
    advance_random_state(keys);
    uvec2 point = uvec2(scramble_reversed(index, keys.x), scramble_reversed(get_second_dimension(index), keys.y));
    first = to_numbers(bitfieldReverse(point));
    advance_random_state(keys);
    point = get_further_dimensions(index);
    second = to_numbers(bitfieldReverse(uvec2(scramble_reversed(point.x, keys.x), scramble_reversed(point.y, keys.y))));
    seed.y += 0x9e3779b9u;
}

// A uniform point of the unit disc in polar coordinates: the squared radius is uniform.
vec2 sample_disc(vec2 u) {
    float angle = 2.0 * PI * u.y;
    return sqrt(u.x) * vec2(sin(angle), cos(angle));
}

// All rays through the same point of the image meet in the plane in focus.
Ray sample_camera_ray(uvec2 pixel, inout uvec2 seed) {
    Camera camera = parameters.camera;
    vec2 on_lens, in_pixel;
    get_joint_numbers(seed, on_lens, in_pixel);

    // Unit vectors across the view: `right` and `up` without the field of view.
    vec3 across = camera.right / length(camera.right), upwards = camera.up / length(camera.up);
    vec2 offset = camera.aperture_radius * sample_disc(on_lens);
    vec3 shift = across * offset.x + upwards * offset.y;

    // The pinhole's direction with a part of 1 along `forward`, and what the shift takes from it at the distance of the focus.
    vec2 image = (vec2(pixel) + in_pixel) / vec2(parameters.image_size);
    vec3 through_middle = camera.forward + (2.0 * image.x - 1.0) * camera.right + (1.0 - 2.0 * image.y) * camera.up;
    vec3 direction = through_middle - shift / camera.focus_distance;
    return Ray(camera.position + shift, normalize(direction));
}
#endif
