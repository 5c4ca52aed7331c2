// Counts rays that escape from a closed mesh around the camera: from near the camera to random vertices (red), points on edges
// (green) and on triangles (blue). parameters.background.x is the largest distance of their origins from the camera along each
// axis.
vec3 path_trace(Ray camera_ray, inout uvec2 seed) {
    vec2 u = get_random_numbers(seed), v = get_random_numbers(seed), w = get_random_numbers(seed);
    uint kind = uint(3.0 * u.y);
    Hit target;
    target.instance = 0u;
    target.triangle = min(uint(u.x * float(triangles.length())), uint(triangles.length()) - 1u);
    target.barycentrics = kind == 0u ? vec2(0.0) : kind == 1u ? vec2(v.x, 0.0) : vec2(v.x, (1.0 - v.x) * v.y);
    vec3 origin = parameters.camera.position + parameters.background.x * (2.0 * vec3(w, fract(256.0 * u.x)) - 1.0);
    Hit hit;
    bool escapes = !trace_ray(Ray(origin, get_surface_point(target).position - origin), NO_LIMIT, hit);
    return escapes ? vec3(kind == 0u, kind == 1u, kind == 2u) : vec3(0.0);
}
