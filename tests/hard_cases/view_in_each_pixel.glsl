// A chapter whose camera rays cover the whole image in every pixel.
#define path_trace path_trace_along
#include "observed.glsl"
#undef path_trace

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Ray camera_ray = get_camera_ray(get_random_numbers(seed));
    return path_trace_along(camera_ray, seed);
}
