// Looks at a random point on a random triangle: red counts those without a unit normal, green those without a position or an
// offset, blue all of them.
#include "random_hit.glsl"

vec3 path_trace(Ray camera_ray, inout uvec2 seed) {
    vec2 u = get_random_numbers(seed), v = get_random_numbers(seed);
    SurfacePoint point = get_surface_point(get_random_hit(u, v));
    bool has_normal = abs(dot(point.geometric_normal, point.geometric_normal) - 1.0) < 1e-5;
    bool has_position = !is_invalid(dot(point.position, vec3(1.0))) && !is_invalid(point.offset);
    return vec3(!has_normal, !has_position, 1.0);
}
