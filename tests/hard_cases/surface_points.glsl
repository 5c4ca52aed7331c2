// Looks at a random point of a random triangle: red counts those without a unit normal, green those without a position
// or an offset, blue all.
vec3 path_trace(Ray camera_ray, inout uvec2 seed) {
    vec2 u = get_random_numbers(seed), v = get_random_numbers(seed);
    Hit hit;
    hit.instance = 0u;
    hit.triangle = min(uint(u.x * float(triangles.length())), uint(triangles.length()) - 1u);
    hit.barycentrics = vec2(sqrt(v.x) * (1.0 - v.y), sqrt(v.x) * v.y);
    SurfacePoint point = get_surface_point(hit);
    bool has_normal = abs(dot(point.geometric_normal, point.geometric_normal) - 1.0) < 1e-5;
    bool has_position = !is_invalid(dot(point.position, vec3(1.0))) && !is_invalid(point.offset);
    return vec3(!has_normal, !has_position, 1.0);
}
