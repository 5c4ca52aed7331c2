// Counts rays that hit the triangle they start from: red counts hits, green all rays. Each sample aims at a random point on a
// random triangle, from a distance between 10^-4 times and once the triangle's size, and leaves the hit in a random direction.
#include "random_hit.glsl"

vec3 random_direction(inout uvec2 seed) {
    vec2 u = get_random_numbers(seed);
    float z = 2.0 * u.x - 1.0, radius = sqrt(max(1.0 - z * z, 0.0));
    return vec3(radius * cos(2.0 * PI * u.y), radius * sin(2.0 * PI * u.y), z);
}

// In world space.
vec3 get_corner(Hit hit, vec2 barycentrics) {
    hit.barycentrics = barycentrics;
    return get_surface_point(hit).position;
}

vec3 path_trace(Ray camera_ray, inout uvec2 seed) {
    vec2 u = get_random_numbers(seed), v = get_random_numbers(seed);
    Hit target = get_random_hit(u, v);
    vec3 x_0 = get_corner(target, vec2(0.0));
    float size = max(max_component(get_corner(target, vec2(1.0, 0.0)) - x_0),
                     max_component(get_corner(target, vec2(0.0, 1.0)) - x_0));
    vec3 direction = random_direction(seed);
    vec3 origin = get_surface_point(target).position - size * pow(10.0, -4.0 * u.y) * direction;
    Hit hit;
    if (!trace_ray(Ray(origin, direction), NO_LIMIT, hit)) return vec3(0.0);
    ShadingData s = get_shading_data(hit, direction);
    Hit next;
    bool is_self_hit =
        trace_ray(get_ray_from_surface(s, random_direction(seed)), NO_LIMIT, next) && next.triangle == hit.triangle;
    return vec3(is_self_hit, 1.0, 0.0);
}
