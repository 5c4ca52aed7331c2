// Smooth functions of random numbers with integral 1: of the first pair after the pixel's, of the second pair, and of one number
// from each.
#include "observation/observed_estimator.glsl"

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec2 u = get_random_numbers(seed), v = get_random_numbers(seed);
    return 4.0 * vec3(u.x * u.y, v.x * v.y, u.x * v.x);
}
