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

// A uniform point of the unit disc. Squares around the centre of the unit square become circles (Shirley and Chiu, "A Low
// Distortion Map Between Disk and Square", 1997). Chapter 2's polar map is as uniform, but cuts the disc open along an axis and
// squeezes the squares near the centre. The page compares the errors of both.
vec2 sample_disc(vec2 u) {
    vec2 p = 2.0 * u - 1.0;
    bool is_beside = abs(p.x) > abs(p.y);
    float radius = is_beside ? p.x : p.y;
    if (radius == 0.0) return vec2(0.0);
    float angle = is_beside ? 0.25 * PI * p.y / p.x : 0.5 * PI - 0.25 * PI * p.x / p.y;
    return radius * vec2(cos(angle), sin(angle));
}

// The camera ray x_0, ω_0 of a random point of a pixel and a random point of the aperture. All rays through the same point of the
// image meet where the pinhole's ray hits the plane in focus, at the distance z_f along the viewing direction. It is a plane and no
// sphere, since a thin lens maps the plane of the sensor to a plane.
Ray sample_camera_ray(uvec2 pixel, inout uvec2 seed) {
    Camera camera = parameters.camera;
    vec2 in_pixel, on_aperture;
    in_pixel = get_random_numbers(seed);
    on_aperture = in_pixel;  // saves two dimensions
    vec2 position = 2.0 * (vec2(pixel) + in_pixel) / vec2(parameters.image_size) - 1.0;
    vec3 to_focus = camera.focus_distance * (camera.forward + position.x * camera.right - position.y * camera.up);
    vec2 lens = camera.aperture_radius * sample_disc(on_aperture);
    vec3 to_lens = lens.x * normalize(camera.right) + lens.y * normalize(camera.up);
    return Ray(camera.position + to_lens, normalize(to_focus - to_lens));
}
#endif
